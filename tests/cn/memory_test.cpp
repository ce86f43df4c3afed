#include <algorithm>
#include <cstring>
#include <random>
#include <set>

#include "firmware/cn/language/kernel.hpp"
#include "tests/support/number_samples.hpp"
#include "tests/support/poly_words.hpp"
#include "tests/support/strip_fixture.hpp"

namespace memory_test {

using cn::InstructionClass;
using cn::LaneMask;
using cn::PolyField;
using cn::PolyMemory;
using cn::PolyMemoryOverflow;
using cn::PolyPointer;
using cn::PolySpan;
using cn::vec3;
using test_support::counts;
using test_support::fill_pairs;
using test_support::load;
using test_support::PerPe;
using test_support::same;
using test_support::store;

TEST(PolyMemoryTest, HandsOutAlignedNeighbours) {
  PolyMemory memory(16, 256);
  EXPECT_EQ(memory.num_pes(), 16);
  EXPECT_EQ(memory.capacity_bytes(), 240);
  EXPECT_EQ(memory.used_bytes(), 0);
  const PolySpan first = memory.allocate("first", 20);
  EXPECT_EQ(first.offset_bytes, 0);
  EXPECT_EQ(first.size_bytes, 24);
  const PolySpan second = memory.allocate("second", 8);
  EXPECT_EQ(second.offset_bytes, 24);
  EXPECT_EQ(second.size_bytes, 8);
  EXPECT_EQ(memory.used_bytes(), 32);
  ASSERT_EQ(memory.buffers().size(), 2u);
  EXPECT_EQ(memory.buffers()[0].name, "first");
  EXPECT_EQ(memory.buffers()[1].span.offset_bytes, 24);
  memory.free_all();
  EXPECT_EQ(memory.used_bytes(), 0);
  EXPECT_EQ(memory.allocate("again", 240).offset_bytes, 0);
}

TEST(PolyMemoryTest, MapListsBuffersFreeBytesAndThePeNumber) {
  PolyMemory memory(8, 256);
  memory.allocate("rays", 56);
  memory.allocate("a buffer with a long name " + std::string(200, 'x'), 8);
  const std::string text = memory.map();
  EXPECT_EQ(text.rfind("  offset   bytes  buffer\n"
                       "       0      56  rays\n"
                       "      56       8  a buffer with a long name ",
                       0),
            0u)
      << text;
  EXPECT_NE(text.find(std::string(200, 'x') + "\n"
                                              "      64     176  (free)\n"
                                              "     240      16  (PE number, reserved by the ABI)\n"),
            std::string::npos)
      << text;
}

TEST(PolyMemoryTest, OverflowNamesTheBufferAndShowsTheMap) {
  PolyMemory memory(8, 128);
  memory.allocate("rays", 64);
  try {
    memory.allocate("hits", 49);
    FAIL() << "no overflow";
  } catch (const PolyMemoryOverflow& overflow) {
    EXPECT_STREQ(overflow.what(),
                 "poly SRAM overflow: buffer 'hits' needs 56 bytes a PE, 48 of 112 are free");
    EXPECT_EQ(overflow.map(), memory.map());
    EXPECT_NE(overflow.map().find("rays"), std::string::npos);
  }
  EXPECT_EQ(memory.used_bytes(), 64) << "a failed allocation leaves nothing behind";
  EXPECT_EQ(memory.allocate("hits", 48).offset_bytes, 64);
}

TEST(PolyMemoryTest, StripsLieOneBehindTheOther) {
  PolyMemory memory(24, 64);
  EXPECT_EQ(memory.strip(0), memory.words());
  EXPECT_EQ(memory.strip(0, 24), memory.words() + 3 * 8);
  EXPECT_EQ(memory.strip_words(), 8u * 8u);
  EXPECT_EQ(memory.strip(16, 8), memory.words() + 2 * 64 + 8);
  const PolyMemory& constant = memory;
  EXPECT_EQ(constant.strip(8), constant.words() + 64);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory.words()) % 64, 0u);
}

TEST(PolyMemoryTest, EachPeHasWordsOfItsOwn) {
  PolyMemory memory(24, 64);
  std::set<const std::uint64_t*> places;
  for (int pe = 0; pe < 24; ++pe)
    for (int offset_bytes = 0; offset_bytes < 64; offset_bytes += 8) {
      EXPECT_EQ(&memory.word(pe, offset_bytes), memory.strip(pe / 8 * 8, offset_bytes) + pe % 8);
      places.insert(&memory.word(pe, offset_bytes));
    }
  EXPECT_EQ(places.size(), 24u * 8u);
  EXPECT_EQ(*places.rbegin() - *places.begin(), 24 * 8 - 1);
}

TEST(LaneMaskTest, HoldsOneBitAPe) {
  LaneMask mask;
  EXPECT_FALSE(mask.any());
  std::vector<bool> expected(cn::kMaxPes);
  std::mt19937 random(2);
  for (int i = 0; i < 3000; ++i) {
    const int pe = static_cast<int>(random() % cn::kMaxPes);
    const bool value = random() % 2 != 0;
    mask.set(pe, value);
    expected[std::size_t(pe)] = value;
  }
  for (int pe = 0; pe < cn::kMaxPes; ++pe) ASSERT_EQ(mask[pe], expected[std::size_t(pe)]) << pe;
  EXPECT_EQ(mask.count(), std::count(expected.begin(), expected.end(), true));
  EXPECT_TRUE(mask.any());
  LaneMask other = mask;
  EXPECT_TRUE(other == mask);
  other.set(1023, !other[1023]);
  EXPECT_FALSE(other == mask);
}

TEST(LaneMaskTest, FirstPesAndStrips) {
  for (const int count : {0, 1, 7, 8, 9, 96, 1023, 1024}) {
    const LaneMask mask = LaneMask::first(count);
    EXPECT_EQ(mask.count(), count);
    for (int pe = 0; pe < cn::kMaxPes; ++pe) ASSERT_EQ(mask[pe], pe < count);
  }
  LaneMask mask = LaneMask::first(12);
  EXPECT_EQ(mask.strip_bits(0), 0xff);
  EXPECT_EQ(mask.strip_bits(1), 0x0f);
  mask.set_strip_bits(1, 0xa0);
  EXPECT_FALSE(mask[11]);
  EXPECT_TRUE(mask[13]);
  EXPECT_TRUE(mask[15]);
  EXPECT_EQ(mask.count(), 10);
}

class PolyFieldTest : public test_support::StripFixture {
 protected:
  PolyFieldTest() {
    std::mt19937_64 random(4);
    for (int w = 0; w < 1024 / 8 * num_pes(); ++w) memory.words()[w] = random();
    before_ = test_support::poly_words(memory, 1024);
  }

  /// Returns the bytes of `T` at `offset` in a PE's SRAM.
  template <class T>
  T in_sram(const std::vector<std::uint64_t>& words, int offset, int pe) const {
    T value;
    std::memcpy(&value,
                reinterpret_cast<const char*>(&words[std::size_t(offset / 8 * num_pes() + pe)]) + offset % 8,
                sizeof(T));
    return value;
  }

  template <class T>
  void expect_writes_enabled_pes_only(int offset) {
    PerPe<T> values = per_pe<T>();
    std::mt19937_64 random(8);
    for (T& value : values) value = test_support::random_value<T>(random);
    PerPe<T> read = values;
    LaneMask enabled;
    for (int pe = 0; pe < num_pes(); ++pe) enabled.set(pe, pe % 4 != 2);
    const PolyField<T> field{offset};
    run(enabled, [&] { field.write(load(values)); });
    EXPECT_EQ(issue_tree.total(), counts({{InstructionClass::sram, sizeof(T) / 4}}));
    run([&] { store(read, field.read()); });
    EXPECT_EQ(issue_tree.total(), counts({{InstructionClass::sram, sizeof(T) / 4}}));

    std::vector<std::uint64_t> expected = before_;
    for (int pe = 0; pe < num_pes(); ++pe) {
      const T old = in_sram<T>(before_, offset, pe);
      EXPECT_TRUE(same(read[std::size_t(pe)], enabled[pe] ? values[std::size_t(pe)] : old)) << "PE " << pe;
      if (enabled[pe])
        std::memcpy(reinterpret_cast<char*>(&expected[std::size_t(offset / 8 * num_pes() + pe)]) + offset % 8,
                    &values[std::size_t(pe)], sizeof(T));
    }
    EXPECT_EQ(test_support::poly_words(memory, 1024), expected) << "a write left its field";
    for (int pe = 0; pe < num_pes(); ++pe)
      memory.word(pe, offset / 8 * 8) = before_[std::size_t(offset / 8 * num_pes() + pe)];
  }

  std::vector<std::uint64_t> before_;
};

TEST_F(PolyFieldTest, EightByteTypes) {
  for (const int offset : {0, 8, 1008}) {
    expect_writes_enabled_pes_only<double>(offset);
    expect_writes_enabled_pes_only<std::int64_t>(offset);
    expect_writes_enabled_pes_only<std::uint64_t>(offset);
  }
}

TEST_F(PolyFieldTest, FourByteTypesInBothHalvesOfAWord) {
  for (const int offset : {0, 4, 16, 20, 1012}) {
    expect_writes_enabled_pes_only<float>(offset);
    expect_writes_enabled_pes_only<std::int32_t>(offset);
    expect_writes_enabled_pes_only<std::uint32_t>(offset);
  }
}

struct Record {
  vec3<double> position{};
  std::int32_t index = 0;
  float weight = 0;
  std::uint64_t place = 0;
  std::uint32_t flags = 0;
  std::int32_t unused = 0;
};

class PolyPointerTest : public PolyFieldTest {};

TEST_F(PolyPointerTest, NamesRecordsAndFields) {
  const PolyPointer<Record> records(PolySpan{64, 3 * sizeof(Record)});
  EXPECT_EQ(PolyPointer<Record>::size_bytes(), 48);
  EXPECT_EQ(records.span().offset_bytes, 64);
  EXPECT_EQ(records.span().size_bytes, 48);
  EXPECT_EQ(records[2].span().offset_bytes, 64 + 96);
  EXPECT_EQ(records[1].field(&Record::index).offset_bytes, 64 + 48 + 24);
  EXPECT_EQ(records.field(&Record::weight).offset_bytes, 64 + 28);
  EXPECT_EQ(records.field(&Record::flags).offset_bytes, 64 + 40);
}

TEST_F(PolyPointerTest, GetsAndSetsByMember) {
  const PolyPointer<Record> record = PolyPointer<Record>(40)[1];
  const LaneMask enabled = LaneMask::first(13);
  const auto pe_value = [] { return cn::convert<double>(cn::pe_num()); };
  run(enabled, [&] {
    record.set(&Record::position, vec3<cn::poly<double>>{pe_value(), pe_value() + 0.25, pe_value() + 0.5});
    record.set(&Record::index, -cn::pe_num());
    record.set(&Record::weight, cn::convert<float>(cn::pe_num()) + 0.75f);
    record.set(&Record::place, cn::poly<std::uint64_t>(0x123456789abcdefu));
    record.set(&Record::flags, cn::poly<std::uint32_t>(0xfedcba98u));
  });
  // One PE's record reads as the plain struct does in mono memory.
  for (int pe = 0; pe < num_pes(); ++pe) {
    std::uint64_t words[6];
    for (int w = 0; w < 6; ++w) words[w] = memory.word(pe, 88 + 8 * w);
    if (!enabled[pe]) {
      for (int w = 0; w < 6; ++w) EXPECT_EQ(words[w], before_[std::size_t((11 + w) * num_pes() + pe)]);
      continue;
    }
    Record found;
    std::memcpy(&found, words, sizeof(found));
    EXPECT_EQ(found.position.x, pe);
    EXPECT_EQ(found.position.y, pe + 0.25);
    EXPECT_EQ(found.position.z, pe + 0.5);
    EXPECT_EQ(found.index, -pe);
    EXPECT_EQ(found.weight, float(pe) + 0.75f);
    EXPECT_EQ(found.place, 0x123456789abcdefu);
    EXPECT_EQ(found.flags, 0xfedcba98u);
  }

  vec3<PerPe<double>> position{per_pe<double>(), per_pe<double>(), per_pe<double>()};
  PerPe<std::int32_t> index = per_pe<std::int32_t>();
  const cn::IssueCounts issued = issued_by([&] {
    const auto read = record.get(&Record::position);
    store(position.x, read.x);
    store(position.y, read.y);
    store(position.z, read.z);
    store(index, record.get(&Record::index));
  });
  EXPECT_EQ(issued, counts({{InstructionClass::sram, 7}}));
  for (std::size_t pe = 0; pe < 13; ++pe) {
    EXPECT_EQ(position.x[pe], double(pe));
    EXPECT_EQ(position.y[pe], double(pe) + 0.25);
    EXPECT_EQ(position.z[pe], double(pe) + 0.5);
    EXPECT_EQ(index[pe], -int(pe));
  }
}

}  // namespace memory_test
