#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "firmware/cn/chip/search_unit.hpp"

namespace search_chain {

/// A search whose steps and answers a test can count by hand: a query names a chain of nodes in mono memory
/// and how many of them to visit; the answer is the sum of their values and, in an array of its own, the
/// address behind the last. A node is 64 bytes: the next node's address, a value, and a number of leaf bytes
/// beside it (0: no leaf), in which there are two to test.
class ChainSearch : public cn::SearchFunction {
 public:
  struct Query {
    std::uint64_t first;
    std::uint64_t nodes;
  };
  struct Node {
    std::uint64_t next;
    std::uint64_t value;
    std::uint64_t leaf_bytes;
  };
  static constexpr int kNodeBytes = 64;

  int answered = 0;  ///< queries so far

  int query_bytes() const override { return int{sizeof(Query)}; }
  std::vector<int> answer_bytes() const override { return {8, 8}; }
  void answer(const Read& mono, const std::vector<cn::SearchFunction::Query>& queries) override {
    using Kind = cn::SearchStep::Kind;
    for (const cn::SearchFunction::Query& of : queries) {
      Query query;
      std::memcpy(&query, of.query, sizeof(query));
      of.steps->clear();
      std::uint64_t sum = 0;
      std::uint64_t at = query.first;
      for (std::uint64_t i = 0; i < query.nodes; ++i) {
        Node node;
        mono(at, &node, sizeof(node));
        of.steps->push_back({Kind::node, 4, at, kNodeBytes});
        if (node.leaf_bytes > 0)
          of.steps->push_back({Kind::leaf, 2, at + kNodeBytes, static_cast<int>(node.leaf_bytes)});
        sum += node.value;
        at = node.next;
      }
      std::memcpy(of.answers[0], &sum, sizeof(sum));
      std::memcpy(of.answers[1], &at, sizeof(at));
      ++answered;
    }
  }
};

}  // namespace search_chain
