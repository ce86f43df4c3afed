#pragma once

#include <cstdint>
#include <vector>

#include "firmware/cn/chip/transfer.hpp"
#include "model/transaction/divisor.hpp"

namespace model {

/// What one PIO request asks of mono memory: a piece of the same size for each PE that takes part, in
/// ascending PE order, and the runs they form. A run is a maximal contiguous sequence of pieces; a request of
/// an array without gaps is one run. Addresses are copied, and the memory for them is kept from one request
/// to the next.
class MonoPieces {
 public:
  struct Run {
    cn::MonoAddress address;
    std::uint64_t bytes;
  };
  /// A list of runs, by PE. It makes room for the most there can be once: a request has up to one run per PE,
  /// and a test for room at each costs more than the run.
  class Runs {
   public:
    std::size_t size() const { return count_; }
    bool empty() const { return count_ == 0; }
    const Run& operator[](std::size_t index) const { return storage_[index]; }
    const Run& front() const { return storage_.front(); }
    const Run* begin() const { return storage_.data(); }
    const Run* end() const { return storage_.data() + count_; }

   private:
    friend class MonoPieces;
    std::vector<Run> storage_;
    std::size_t count_ = 0;
  };
  struct Rules {
    Divisor packet_bytes;
    /// Equal addresses of a read are fetched once, for the lowest PE that has them, and broadcast (US
    /// 7,363,472). Writes never are: each PE has its own data.
    bool consolidate_equal_addresses;
  };

  MonoPieces() = default;

  void describe(const cn::Transfer& transfer, int num_pes, const Rules& rules);

  cn::Direction direction() const { return direction_; }
  bool write() const { return direction_ == cn::Direction::poly_to_mono; }
  /// The places of all PEs, whether they take part or not.
  cn::MonoPlaces places() const {
    return by_pe_.empty() ? cn::MonoPlaces::array(first_, stride_bytes_)
                          : cn::MonoPlaces::each(by_pe_.data(), first_);
  }
  const cn::LaneMask& enabled() const { return enabled_; }
  int bytes_per_pe() const { return bytes_per_pe_; }

  int pes() const { return pes_; }        ///< PEs that take part
  int pieces() const { return pieces_; }  ///< addressed pieces: `pes` less the consolidated ones
  /// Pieces off an 8-byte boundary, or across more packet boundaries than their size makes necessary
  /// (docs/csx600.md, section 2, counts none for an array of 80-byte pieces in 64-byte packets).
  int misaligned() const { return misaligned_; }
  std::uint64_t poly_bytes() const { return std::uint64_t(pes_) * std::uint64_t(bytes_per_pe_); }
  std::uint64_t mono_bytes() const { return std::uint64_t(pieces_) * std::uint64_t(bytes_per_pe_); }
  std::uint64_t packets() const { return packets_; }  ///< each run is cut into packets from its start
  const Runs& runs() const { return runs_; }
  /// Whether no piece reaches beyond `size_bytes`.
  bool within(std::uint64_t size_bytes) const { return end_ <= size_bytes; }

 private:
  class SeenAddresses {
   public:
    void clear();
    /// Whether `address` comes for the first time.
    bool insert(cn::MonoAddress address);

   private:
    static constexpr std::size_t kSlots = 2 * cn::kMaxPes;
    struct Slot {
      cn::MonoAddress address = 0;
      std::uint64_t generation = 0;
    };
    std::vector<Slot> slots_;
    std::uint64_t generation_ = 0;
  };

  /// One bit a piece of a packed array: whether it is misaligned. Offsets within packets and words repeat
  /// after a period, so for one that divides 64 the same word holds for every 64 pieces.
  struct MisalignedPattern {
    std::uint64_t offset = ~std::uint64_t{0};  ///< where in its packet the array's first byte lies
    std::uint64_t bytes = 0;                   ///< bytes of a piece
    bool repeats = false;
    std::uint64_t word = 0;
  };
  /// Firmware requests a few arrays over and over.
  static constexpr std::size_t kKnownPatterns = 64;

  bool describe_packed_array(int num_pes, const Rules& rules);
  const MisalignedPattern& pattern(const Rules& rules);
  void describe_each(int num_pes, const Rules& rules);
  template <class AddressOf>
  void collect(int num_pes, const AddressOf& address_of);
  void consolidate();
  void append_run(cn::MonoAddress address, std::uint64_t bytes, const Divisor& packet_bytes);

  cn::Direction direction_ = cn::Direction::mono_to_poly;
  cn::MonoAddress first_ = 0;
  std::uint64_t stride_bytes_ = 0;
  std::vector<cn::MonoAddress> by_pe_;
  cn::LaneMask enabled_;
  int bytes_per_pe_ = 0;
  int pes_ = 0;
  int pieces_ = 0;
  int misaligned_ = 0;
  std::uint64_t packets_ = 0;
  cn::MonoAddress end_ = 0;
  Runs runs_;
  std::vector<MisalignedPattern> patterns_;
  std::vector<cn::MonoAddress> addresses_;  ///< addresses of the pieces, while they are described
  SeenAddresses seen_;
};

}  // namespace model
