#include "model/config/address_map.hpp"

#include <gtest/gtest.h>

#include "model/config/chip_parameters.hpp"
#include "tests/support/chip_config_support.hpp"

namespace model {
namespace address_map_test {

std::string refusal(AddressMap& map, const std::string& name, const cn::MonoRange& range) {
  try {
    map.add(name, range);
  } catch (const AddressMapError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(AddressMap, FindsTheRangeThatHoldsAllBytes) {
  AddressMap map;
  map.add("low", {0, 0x100});
  map.add("high", {0x200, 0x80});
  EXPECT_EQ(map.find(0, 0x100), 0);
  EXPECT_EQ(map.find(0xff, 1), 0);
  EXPECT_EQ(map.find(0x200, 0x80), 1);
  EXPECT_EQ(map.find(0xf8, 16), AddressMap::kNowhere) << "ends in the hole";
  EXPECT_EQ(map.find(0x100, 8), AddressMap::kNowhere) << "in the hole";
  EXPECT_EQ(map.find(0x1f8, 16), AddressMap::kNowhere) << "begins in the hole";
  EXPECT_EQ(map.find(0x27f, 2), AddressMap::kNowhere) << "beyond all";
  EXPECT_EQ(map.find(~std::uint64_t{0}, 2), AddressMap::kNowhere) << "its end has no address";
  EXPECT_EQ(map.text(), "0x0 to 0xff and 0x200 to 0x27f");
}

TEST(AddressMap, NeighboursDoNotFormOneRange) {
  AddressMap map;
  map.add("low", {0, 0x100});
  map.add("next", {0x100, 0x100});
  EXPECT_EQ(map.find(0xf8, 8), 0);
  EXPECT_EQ(map.find(0x100, 8), 1);
  EXPECT_EQ(map.find(0xf8, 16), AddressMap::kNowhere);
}

TEST(AddressMap, RefusesWhatCannotBe) {
  AddressMap map;
  map.add("ddr", {0x1000, 0x1000});
  EXPECT_EQ(refusal(map, "none", {0x4000, 0}),
            "address map: none: found 0 bytes at 0x4000; allowed: at least 1 byte");
  EXPECT_EQ(refusal(map, "x", {0x1fff, 8}),
            "address map: x: found 8 bytes at 0x1fff; allowed: addresses outside ddr (0x1000 to 0x1fff)");
  EXPECT_EQ(refusal(map, "x", {0x800, 0x801}),
            "address map: x: found 2049 bytes at 0x800; allowed: addresses outside ddr (0x1000 to 0x1fff)");
  EXPECT_EQ(refusal(map, "x", {0, 0x4000}),
            "address map: x: found 16384 bytes at 0x0; allowed: addresses outside ddr (0x1000 to 0x1fff)");
  EXPECT_EQ(refusal(map, "x", {~std::uint64_t{0}, 2}),
            "address map: x: found 2 bytes at 0xffffffffffffffff; allowed: a last byte at "
            "0xffffffffffffffff or before");
  EXPECT_EQ(refusal(map, "ddr", {0x4000, 8}), "address map: found two ranges 'ddr'; allowed: one");
  EXPECT_EQ(refusal(map, "last", {~std::uint64_t{0}, 1}), "accepted");
  EXPECT_EQ(map.size(), 2) << "what was refused is not there";
}

TEST(AddressMap, OfTheShippedChip) {
  const AddressMap map = address_map(default_chip_config());
  EXPECT_EQ(map.text(), "0x0 to 0x1fffffff and 0x10000000000 to 0x1000001ffff");
}

TEST(AddressMap, OfAChipWithoutSram) {
  ChipConfig config = default_chip_config();
  config.on_chip_sram.size_bytes = 0;
  EXPECT_EQ(address_map(config).size(), 1);
}

TEST(AddressMap, SramWithinTheDdrIsWrongInput) {
  ChipConfig config = default_chip_config();
  config.on_chip_sram.first_address = config.ddr.size_bytes - 65536;
  EXPECT_EQ(error_of([&] { validate(config, "chip.toml"); }),
            "chip.toml: on_chip_sram.first_address: found '536805376'; allowed: at least ddr.size_bytes "
            "(536870912)");
  config.on_chip_sram.size_bytes = 0;
  EXPECT_NO_THROW(validate(config)) << "no SRAM, nothing to overlap";
  config.on_chip_sram.size_bytes = 1024;
  config.on_chip_sram.first_address = config.ddr.size_bytes;
  EXPECT_NO_THROW(validate(config)) << "right behind the DDR";
}

}  // namespace address_map_test
}  // namespace model
