// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/texts.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#ifndef __cpp_lib_to_chars
#include <locale.h>
#include <stdlib.h>
#ifdef __APPLE__
#include <xlocale.h>
#endif
#endif

namespace mujoco_impact::engine {

namespace {

constexpr std::string_view kSpaces = " \t\n";

// Reads a word that is a number and nothing else.
bool ReadNumber(std::string_view word, double* value) {
  const char *const begin = word.data(), *const end = begin + word.size();
#ifdef __cpp_lib_to_chars
  const auto [next, status] = std::from_chars(begin, end, *value);
  return status == std::errc() && next == end && std::isfinite(*value);
#else
  // libc++ of before 2025 reads integers only; strtod takes signs and words that are none here
  if (word.front() == '+' || word.find_first_not_of("0123456789.eE+-") != word.npos) return false;
  const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
  char* next = nullptr;
  *value = strtod_l(begin, &next, plain);
  freelocale(plain);
  return next == end && std::isfinite(*value);
#endif
}

}  // namespace

std::string_view TakePart(std::string_view& text, char separator) {
  const size_t length = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, length);
  text.remove_prefix(std::min(length + 1, text.size()));
  return part;
}

std::string_view TakeWord(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kSpaces), text.size()));
  const size_t length = std::min(text.find_first_of(kSpaces), text.size());
  const std::string_view word = text.substr(0, length);
  text.remove_prefix(length);
  return word;
}

int ReadList(std::string_view text, double* values, int size) {
  int count = 0;
  for (;;) {
    const std::string_view word = TakeWord(text);
    if (word.empty()) return count;
    double value = 0.0;
    if (!ReadNumber(word, &value)) return -1;
    if (count < size) values[count] = value;
    ++count;
  }
}

int ShownLength(std::string_view text, int most) {
  int length = static_cast<int>(std::min<size_t>(text.size(), most));
  const auto continues = [&](int i) { return (text[i] & 0xC0) == 0x80; };
  while (length > 0 && length < static_cast<int>(text.size()) && continues(length)) --length;
  return length;
}

}  // namespace mujoco_impact::engine
