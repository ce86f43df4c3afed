#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "firmware/cn/chip/mono_memory.hpp"

namespace plug_in {

/// What the host does with a buffer: before the firmware starts, and after it has ended.
enum class Use : std::uint8_t { scratch, upload, download, upload_and_download };

/// The memory that a buffer lies in. The one on the chip is small and quick, and read beside the other
/// (cn::Machine::scratchpad()).
enum class Memory : std::uint8_t { ddr, on_chip_sram };

/// A buffer in mono memory and its copy on the host, as the program that runs the firmware sees it.
class MonoBufferBase {
 public:
  MonoBufferBase(std::string name, Use use) : name_(std::move(name)), use_(use) {}
  virtual ~MonoBufferBase() = default;
  MonoBufferBase(const MonoBufferBase&) = delete;
  MonoBufferBase& operator=(const MonoBufferBase&) = delete;

  const std::string& name() const { return name_; }
  bool is_uploaded() const { return use_ == Use::upload || use_ == Use::upload_and_download; }
  bool is_downloaded() const { return use_ == Use::download || use_ == Use::upload_and_download; }
  virtual void* host_bytes() = 0;
  virtual std::uint64_t size_bytes() const = 0;

  Memory memory() const { return memory_; }
  /// To be called by prepare(), at the latest.
  void put_in(Memory memory) { memory_ = memory; }
  cn::MonoAddress address() const { return address_; }
  void place_at(cn::MonoAddress address) { address_ = address; }

 private:
  std::string name_;
  Use use_;
  Memory memory_ = Memory::ddr;
  cn::MonoAddress address_ = 0;
};

/// An array in mono memory: `MonoBuffer<float> x{*this, "x", plug_in::Use::upload}`. The firmware addresses
/// mono(); prepare() and check() use the host's copy.
template <class T>
class MonoBuffer : public MonoBufferBase {
  static_assert(std::is_trivially_copyable_v<T>, "mono memory holds plain bytes");

 public:
  /// @param owner a Firmware, which lists its buffers
  template <class Owner>
  MonoBuffer(Owner& owner, std::string name, Use use) : MonoBufferBase(std::move(name), use) {
    owner.add(*this);
  }

  void resize(std::size_t elements) { host_.resize(elements); }
  std::size_t size() const { return host_.size(); }
  T& operator[](std::size_t index) { return host_[index]; }
  const T& operator[](std::size_t index) const { return host_[index]; }
  auto begin() { return host_.begin(); }
  auto end() { return host_.end(); }
  auto begin() const { return host_.begin(); }
  auto end() const { return host_.end(); }

  cn::MonoPointer<T> mono() const { return {address()}; }
  /// Where each PE's piece of a copy lies: side by side, `elements` for each PE, from element `first` on.
  cn::MonoPlaces places(std::size_t first, std::size_t elements) const {
    return cn::MonoPlaces::array((mono() + first).address, elements * sizeof(T));
  }

  void* host_bytes() override { return host_.data(); }
  std::uint64_t size_bytes() const override { return host_.size() * sizeof(T); }

 private:
  std::vector<T> host_;
};

}  // namespace plug_in
