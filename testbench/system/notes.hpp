#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace testbench {

/// What a loader left out or put in place of something, collected while it reads and printed by the command
/// line. Notes of the same text are one kind: its line says where it occurred first and how often.
class Notes {
 public:
  /// Adds `count` occurrences of `text`, a clause such as "transparency (d, Tr) is left out". `where` is the
  /// file, or the file and the line or part, of the first of them. Adds no note if `count` is 0.
  void add(const std::string& text, const std::string& where, std::size_t count = 1);

  /// The same once, where the text of `where()` is only made if it is needed.
  template <class Where>
  void add_at(const char* text, const Where& where) {
    if (!count_again(text)) add(text, where());
  }

  /// Adds all of `others`.
  void add(const Notes& others);

  /// One line for each kind in the order of their first occurrence, without a final line break:
  /// "box.mtl:7: transparency (d, Tr) is left out", and ", 3 times" if it occurred more than once.
  std::vector<std::string> lines() const;

 private:
  /// Whether there is a note of this text already; counts one more of it if so.
  bool count_again(const char* text);

  struct Note {
    std::string text;
    std::string first_where;
    std::size_t count;
  };
  std::vector<Note> notes_;
};

}  // namespace testbench
