// What the tests of lists that keep their best elements put into them.
#ifndef WIREPOSE_TESTS_BASE_SCORED_ITEM_H_
#define WIREPOSE_TESTS_BASE_SCORED_ITEM_H_

namespace wirepose::testing {

struct Item {
  int score;
  int id;
  bool operator==(const Item&) const = default;
};
// Higher score first, lower id among equals: a strict total order.
struct Better {
  bool operator()(const Item& a, const Item& b) const { return a.score != b.score ? a.score > b.score : a.id < b.id; }
};

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_BASE_SCORED_ITEM_H_
