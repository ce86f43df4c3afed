// The intervals of a packet cull no box that one of its rays meets, and most boxes that none meets.

#include "firmware/path_tracer/traversals/packet_bounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "testbench/run/render.hpp"

namespace packet_bounds_test {

using cn::LaneMask;
using path_tracer::kAxes;
using path_tracer::kPacketBounds;
using path_tracer::MonoNode;
using path_tracer::PacketBounds;
using path_tracer::PacketRecord;
using path_tracer::TraversalRecord;

struct Ray {
  double origin[kAxes];
  double direction[kAxes];
};

struct Box {
  double lower[kAxes];
  double upper[kAxes];
};

constexpr int kPes = 64;
constexpr int kBlocks = 2;

class Packet {
 public:
  /// @param spread of the rays about a common origin and direction
  Packet(unsigned seed, double spread) : random_(seed), memory_(kPes, 4096) {
    double origin[kAxes];
    double direction[kAxes];
    for (int axis = 0; axis < kAxes; ++axis) {
      origin[axis] = number(-5, 5);
      direction[axis] = number(-1, 1);
    }
    for (int i = 0; i < kPes * kBlocks; ++i) {
      Ray ray;
      for (int axis = 0; axis < kAxes; ++axis) {
        ray.origin[axis] = origin[axis] + spread * number(-1, 1);
        ray.direction[axis] = direction[axis] + spread * number(-1, 1);
      }
      rays_.push_back(ray);
    }
  }

  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  Box box() {
    Box box;
    for (int axis = 0; axis < kAxes; ++axis) {
      box.lower[axis] = number(-10, 10);
      box.upper[axis] = box.lower[axis] + number(0, 3);
    }
    return box;
  }

  PacketBounds bounds() {
    const path_tracer::LargePacketKernels& kernels =
        path_tracer::kernels(testbench::widest_level()).large_packet();
    const cn::PolyPointer<TraversalRecord> record(0);
    const cn::PolyPointer<PacketRecord> packet(int{sizeof(TraversalRecord)});
    const int bounds_at = int{sizeof(TraversalRecord)} + int{sizeof(PacketRecord)};
    cn::IssueTree issued;
    for (int block = 0; block < kBlocks; ++block) {
      for (int pe = 0; pe < kPes; ++pe) write(pe, rays_[std::size_t(block * kPes + pe)], record, packet);
      kernels.bound.run({record, packet, {bounds_at}, block == 0}, memory_, LaneMask::first(kPes), issued);
    }
    std::array<std::int32_t, kPacketBounds> least;
    least.fill(0x7fffffff);
    kernels.keep_bounds.run({{bounds_at}, least.data()}, memory_, LaneMask::first(kPes), issued);
    return PacketBounds(least);
  }

  bool meets(const Box& box) const {
    return std::any_of(rays_.begin(), rays_.end(), [&](const Ray& ray) {
      double entry = 0;
      double exit = INFINITY;
      for (int axis = 0; axis < kAxes; ++axis) {
        const double scale = -1.0 / ray.direction[axis];
        const double a = (ray.origin[axis] - box.lower[axis]) * scale;
        const double b = (ray.origin[axis] - box.upper[axis]) * scale;
        entry = std::max(entry, std::min(a, b));
        exit = std::min(exit, std::max(a, b));
      }
      return entry <= exit;
    });
  }

 private:
  void write(int pe, const Ray& ray, cn::PolyPointer<TraversalRecord> record,
             cn::PolyPointer<PacketRecord> packet) {
    const auto put = [&](int offset_bytes, double value) {
      std::memcpy(&memory_.word(pe, offset_bytes), &value, sizeof(value));
    };
    for (int axis = 0; axis < kAxes; ++axis) {
      put(record.span().offset_bytes + 8 * axis, ray.origin[axis]);
      put(packet.span().offset_bytes + 8 * axis, -1.0 / ray.direction[axis]);
    }
  }

  std::mt19937 random_;
  cn::PolyMemory memory_;
  std::vector<Ray> rays_;
};

MonoNode node_of(const Box& box) {
  MonoNode node{};
  for (std::size_t axis = 0; axis < std::size_t(kAxes); ++axis) {
    node.four[0].lower[axis][0] = box.lower[axis];
    node.four[0].upper[axis][0] = box.upper[axis];
  }
  node.children = 1;
  return node;
}

TEST(PacketBounds, CullNoBoxThatARayMeetsAndMostOthers) {
  int culled = 0;
  int missed = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const double spread = seed % 4 == 3 ? 2.0 : std::pow(10.0, -double(seed % 4) - 1);
    Packet packet(seed, spread);
    const PacketBounds bounds = packet.bounds();
    for (int i = 0; i < 100; ++i) {
      const Box box = packet.box();
      const bool is_culled = bounds.culls() && bounds.misses(node_of(box), 0);
      if (packet.meets(box)) {
        ASSERT_FALSE(is_culled) << "seed " << seed << ", box " << i;
      } else if (spread < 0.05) {
        ++missed;
        culled += is_culled;
      }
    }
  }
  EXPECT_GT(missed, 5000);
  EXPECT_GT(culled, missed * 9 / 10) << "of a packet of nearly parallel rays";
}

TEST(PacketBounds, CullNothingOfRaysInAllDirections) {
  Packet packet(5, 3.0);
  EXPECT_FALSE(packet.bounds().culls());
}

}  // namespace packet_bounds_test
