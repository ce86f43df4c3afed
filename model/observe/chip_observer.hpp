#pragma once

#include <vector>

#include "model/observe/control_observer.hpp"
#include "model/observe/memory_observer.hpp"
#include "model/observe/pio_observer.hpp"

namespace model {

/// Told what the chip does. An observer overrides only what it needs.
class ChipObserver : public ControlObserver, public PioObserver, public HostObserver {
 public:
  void spent(CycleCause, Cycles, Cycles, int) override {}
  void ran_kernel(const char*, Cycles, Cycles, int) override {}
  void started(const PioEvent&) override {}
  void finished(const PioEvent&) override {}
  void began_transfer(bool, std::uint64_t, Cycles) override {}
  void ended_transfer(bool, std::uint64_t, Cycles, Cycles) override {}
};

/// Passes everything on to several observers.
class ChipObservers : public ChipObserver {
 public:
  void add(ChipObserver& observer) { observers_.push_back(&observer); }
  bool empty() const { return observers_.empty(); }

  void began(CycleCause cause, Cycles start, int semaphore) override {
    for (ChipObserver* const observer : observers_) observer->began(cause, start, semaphore);
  }
  void kernel_details(const KernelDetails& details) override {
    for (ChipObserver* const observer : observers_) observer->kernel_details(details);
  }
  void began_kernel(const char* name, Cycles start, int enabled_pes) override {
    for (ChipObserver* const observer : observers_) observer->began_kernel(name, start, enabled_pes);
  }
  void spent(CycleCause cause, Cycles start, Cycles finish, int semaphore) override {
    for (ChipObserver* const observer : observers_) observer->spent(cause, start, finish, semaphore);
  }
  void ran_kernel(const char* name, Cycles start, Cycles finish, int enabled_pes) override {
    for (ChipObserver* const observer : observers_) observer->ran_kernel(name, start, finish, enabled_pes);
  }
  void thread_changed(int thread, ThreadState state, Cycles at) override {
    for (ChipObserver* const observer : observers_) observer->thread_changed(thread, state, at);
  }
  void filled(int block, int slots, Cycles at) override {
    for (ChipObserver* const observer : observers_) observer->filled(block, slots, at);
  }
  void started(const PioEvent& event) override {
    for (ChipObserver* const observer : observers_) observer->started(event);
  }
  void finished(const PioEvent& event) override {
    for (ChipObserver* const observer : observers_) observer->finished(event);
  }
  void began_transfer(bool upload, std::uint64_t bytes, Cycles start) override {
    for (ChipObserver* const observer : observers_) observer->began_transfer(upload, bytes, start);
  }
  void ended_transfer(bool upload, std::uint64_t bytes, Cycles start, Cycles finish) override {
    for (ChipObserver* const observer : observers_) observer->ended_transfer(upload, bytes, start, finish);
  }

 private:
  std::vector<ChipObserver*> observers_;
};

}  // namespace model
