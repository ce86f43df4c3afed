#pragma once

#include <cstddef>
#include <memory>
#include <systemc>
#include <vector>

namespace model {

/// Lets the processes that run firmware come last at a time: each goes on when everything else that happens
/// at that time has happened. Those of several chips would wait for each other without end if each watched
/// for itself. So one of those that wait watches for all, and they go on one after the other in the order of
/// their places, whichever the kernel runs first.
class LastInTime {
 public:
  /// The place of one more process.
  std::size_t join();
  /// To be called by the process of `place`; returns when it comes last.
  void come_last(std::size_t place);

 private:
  struct Member {
    bool waits = false;
    sc_core::sc_event turn;
  };
  class Wait;

  /// The first place that waits; there must be one.
  std::size_t first_waiting() const;
  void let_watch(std::size_t place);

  std::vector<std::unique_ptr<Member>> members_;
  bool watched_ = false;  ///< one of those that wait watches, or is woken to do so
};

}  // namespace model
