// SPDX-License-Identifier: Apache-2.0
// Numbers, words and entries in the text of an attribute.

#ifndef MUJOCO_IMPACT_ENGINE_SCENE_TEXTS_H_
#define MUJOCO_IMPACT_ENGINE_SCENE_TEXTS_H_

#include <string_view>

namespace mujoco_impact::engine {

// A number with its default and the open or closed interval it must lie in.
struct NumberRule {
  const char* name;
  double fallback;
  double low, high;
  bool low_allowed, high_allowed;
  const char* allowed;

  bool Allows(double value) const {
    return (low_allowed ? value >= low : value > low) &&
           (high_allowed ? value <= high : value < high);
  }
};

// Reads up to `size` numbers of a list separated by spaces; returns how many it holds, -1 if a
// word is not a finite number.
int ReadList(std::string_view text, double* values, int size);

// The text up to the separator, which is taken off `text` with it; all of it if there is none.
std::string_view TakePart(std::string_view& text, char separator);

// The next word, empty at the end, which is taken off `text`.
std::string_view TakeWord(std::string_view& text);

// Length of the beginning of a text that has at most `most` bytes and no part of a character of
// UTF-8.
int ShownLength(std::string_view text, int most);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SCENE_TEXTS_H_
