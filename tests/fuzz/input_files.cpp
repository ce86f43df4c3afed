#include "tests/fuzz/input_files.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace fuzz {

void write_file(const char* name, std::string_view bytes) {
  std::ofstream file(name, std::ios::binary);
  file.write(bytes.data(), std::streamsize(bytes.size()));
  if (!file.flush()) std::abort();
}

void write_parts(std::string_view input, std::initializer_list<const char*> names) {
  constexpr std::string_view kBetween = "\n====\n";
  bool is_left = true;
  for (const char* const name : names) {
    if (!is_left) {
      std::filesystem::remove(name);
      continue;
    }
    const std::size_t end = input.find(kBetween);
    write_file(name, input.substr(0, end));
    is_left = end != std::string_view::npos;
    if (is_left) input.remove_prefix(end + kBetween.size());
  }
}

}  // namespace fuzz
