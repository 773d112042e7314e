// SPDX-License-Identifier: Apache-2.0

#include "engine/island/islands.h"

#include <algorithm>

#include "engine/common/tree_sets.h"
#include "engine/scene/tree_kinds.h"

namespace mujoco_impact::engine {

namespace {

int MovingTree(const ContactTrees& trees) {
  return trees.tree[0] >= 0 ? trees.tree[0] : trees.tree[1];
}

}  // namespace

Islands FindIslands(const mjModel* m, const Mobility& mobility, const Stops& stops,
                    const mjContact* const* contacts, const bool* due, const bool* near, int count,
                    Scratch& scratch) {
  TreeSets sets(m->ntree, scratch);
  if (mobility.ties() > 0) {
    for (int tree = 0; tree < m->ntree; ++tree) sets.Join(tree, mobility.Group(tree));
  }
  stops.Join(sets);
  for (int i = 0; i < count; ++i) {
    if (!near[i]) continue;
    const ContactTrees trees = TreesOf(m, *contacts[i]);
    if (trees.tree[0] >= 0 && trees.tree[1] >= 0) sets.Join(trees.tree[0], trees.tree[1]);
  }

  // number the islands in which something closes, in the order of their first closing contact
  int* island_of = scratch.Take<int>(m->ntree);
  std::fill_n(island_of, m->ntree, -1);
  const auto root = [&](int i) { return sets.Root(MovingTree(TreesOf(m, *contacts[i]))); };
  int number = 0;
  for (int i = 0; i < count; ++i) {
    if (due[i] && island_of[root(i)] < 0) island_of[root(i)] = number++;
  }

  // counting sort of the contacts by island
  int* start = scratch.Take<int>(number + 2);
  std::fill_n(start, number + 2, 0);
  for (int i = 0; i < count; ++i) {
    if (near[i] && island_of[root(i)] >= 0) ++start[island_of[root(i)] + 2];
  }
  for (int k = 2; k < number + 2; ++k) start[k] += start[k - 1];
  int* sorted = scratch.Take<int>(count);
  for (int i = 0; i < count; ++i) {
    const int island = near[i] ? island_of[root(i)] : -1;
    if (island >= 0) sorted[start[island + 1]++] = i;
  }
  return {number, start, sorted};
}

}  // namespace mujoco_impact::engine
