#include "testbench/system/notes.hpp"

#include <algorithm>

namespace testbench {

void Notes::add(const std::string& text, const std::string& where, std::size_t count) {
  if (count == 0) return;
  const auto same =
      std::find_if(notes_.begin(), notes_.end(), [&](const Note& note) { return note.text == text; });
  if (same == notes_.end())
    notes_.push_back({text, where, count});
  else
    same->count += count;
}

bool Notes::count_again(const char* text) {
  const auto same =
      std::find_if(notes_.begin(), notes_.end(), [&](const Note& note) { return note.text == text; });
  if (same == notes_.end()) return false;
  ++same->count;
  return true;
}

void Notes::add(const Notes& others) {
  for (const Note& note : others.notes_) add(note.text, note.first_where, note.count);
}

std::vector<std::string> Notes::lines() const {
  std::vector<std::string> lines;
  for (const Note& note : notes_)
    lines.push_back(note.first_where + ": " + note.text +
                    (note.count > 1 ? ", " + std::to_string(note.count) + " times" : ""));
  return lines;
}

}  // namespace testbench
