#pragma once

#include <algorithm>
#include <random>

#include "tests/support/strip_fixture.hpp"

/// Random structured programs that run twice: by cn, strip by strip, and by an interpreter that keeps all PEs
/// in lock step as the chip does. Both must leave the same variables and issue the same instructions.
namespace test_support {

inline constexpr int kVariables = 4;     ///< 32-bit variables that statements use
inline constexpr int kMaxLoopDepth = 3;  ///< each level has one more variable, which counts its passes

struct Statement;
using Block = std::vector<Statement>;

struct Statement {
  enum class Kind { assign, if_then, if_then_else, if_any, loop } kind = Kind::assign;
  int target = 0;
  int left = 0;
  int right = 0;
  std::int32_t constant = 0;  ///< assignment: added; condition: compared with (variable & 7)
  int loop_depth = 0;
  Block body;
  Block otherwise;
};

class ProgramGenerator {
 public:
  explicit ProgramGenerator(unsigned seed) : random_(seed) {}

  Block block(int depth, int loop_depth) {
    Block statements;
    for (int i = pick(1, 3); i > 0; --i) statements.push_back(statement(depth, loop_depth));
    return statements;
  }

 private:
  int pick(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  Statement statement(int depth, int loop_depth) {
    using Kind = Statement::Kind;
    Statement made;
    made.kind = depth == 0 ? Kind::assign : static_cast<Kind>(pick(0, 4));
    if (made.kind == Kind::loop && loop_depth == kMaxLoopDepth) made.kind = Kind::if_any;
    made.target = pick(0, kVariables - 1);
    made.left = pick(0, kVariables - 1);
    made.right = pick(0, kVariables - 1);
    made.constant = pick(0, 8);
    made.loop_depth = loop_depth;
    if (made.kind == Kind::assign) return made;
    made.body = block(depth - 1, loop_depth + (made.kind == Kind::loop ? 1 : 0));
    if (made.kind == Kind::if_then_else) made.otherwise = block(depth - 1, loop_depth);
    return made;
  }

  std::mt19937 random_;
};

/// Values of all variables of all PEs, and the issued instructions.
struct Outcome {
  std::vector<PerPe<std::int32_t>> variables;
  cn::IssueCounts issued;
  std::uint64_t lane_instructions = 0;  ///< sum over instructions of the PEs that entered their region
};

/// Runs the program as Cn code.
class CnRun {
 public:
  explicit CnRun(std::vector<PerPe<std::int32_t>>& variables) : memory_(variables) {
    for (std::size_t i = 0; i < variables.size(); ++i) variables_[i].assign_all_lanes(load(variables[i]));
  }
  ~CnRun() {
    for (std::size_t i = 0; i < memory_.size(); ++i) store(memory_[i], variables_[i]);
  }

  void run(const Block& block) {
    for (const Statement& statement : block) run(statement);
  }

 private:
  cn::mask condition(const Statement& s) { return (variables_[s.left] & 7) < s.constant; }

  void run(const Statement& s) {
    const auto body = [&] { run(s.body); };
    switch (s.kind) {
      case Statement::Kind::assign:
        variables_[s.target] = variables_[s.left] * 3 + variables_[s.right] + s.constant;
        break;
      case Statement::Kind::if_then:
        cn::poly_if(condition(s), body);
        break;
      case Statement::Kind::if_then_else:
        cn::poly_if(condition(s), body, [&] { run(s.otherwise); });
        break;
      case Statement::Kind::if_any:
        cn::poly_if_any(condition(s), body);
        break;
      case Statement::Kind::loop: {
        cn::poly<std::int32_t>& passes = variables_[kVariables + s.loop_depth];
        passes = variables_[s.left] & 3;
        cn::poly_while([&] { return passes > 0; },
                       [&] {
                         passes = passes - 1;
                         run(s.body);
                       });
        break;
      }
    }
  }

  std::vector<PerPe<std::int32_t>>& memory_;
  cn::poly<std::int32_t> variables_[kVariables + kMaxLoopDepth];
};

/// Interprets the program as the chip runs it: one instruction stream, and one enable stack per PE.
class LockStepRun {
 public:
  LockStepRun(std::vector<PerPe<std::int32_t>> variables, const cn::LaneMask& enabled) {
    outcome_.variables = std::move(variables);
    for (std::size_t pe = 0; pe < outcome_.variables[0].size(); ++pe) enabled_.push_back(enabled[int(pe)]);
    region_lanes_ = lanes();
  }

  const Outcome& run(const Block& block) {
    for (const Statement& statement : block) run(statement);
    return outcome_;
  }

 private:
  using Bits = std::vector<bool>;
  using Class = cn::InstructionClass;

  void issue(Class instruction, std::uint64_t times = 1) {
    outcome_.issued[instruction] += times;
    outcome_.lane_instructions += times * region_lanes_;
  }
  std::uint64_t lanes() const { return std::uint64_t(std::count(enabled_.begin(), enabled_.end(), true)); }

  template <class Body>
  void region(Body&& body) {
    const std::uint64_t outer_lanes = region_lanes_;
    region_lanes_ = lanes();
    body();
    region_lanes_ = outer_lanes;
  }

  template <class Value>
  void assign(int target, Value&& value) {
    issue(Class::move);
    for (std::size_t pe = 0; pe < enabled_.size(); ++pe)
      if (enabled_[pe]) outcome_.variables[std::size_t(target)][pe] = value(pe);
  }
  std::int32_t& variable(int index, std::size_t pe) { return outcome_.variables[std::size_t(index)][pe]; }

  Bits condition(const Statement& s) {
    issue(Class::int32_alu, 2);  // and, compare
    Bits holds;
    for (std::size_t pe = 0; pe < enabled_.size(); ++pe)
      holds.push_back((variable(s.left, pe) & 7) < s.constant);
    return holds;
  }
  static Bits both(const Bits& a, const Bits& b) {
    Bits result;
    for (std::size_t pe = 0; pe < a.size(); ++pe) result.push_back(a[pe] && b[pe]);
    return result;
  }

  void run_if(const Statement& s) {
    const Bits holds = condition(s);
    const Bits outer = enabled_;
    issue(Class::enable);
    enabled_ = both(outer, holds);
    run(s.body);
    if (s.kind == Statement::Kind::if_then_else) {
      issue(Class::enable);
      Bits fails = holds;
      fails.flip();
      enabled_ = both(outer, fails);
      run(s.otherwise);
    }
    issue(Class::enable);
    enabled_ = outer;
  }

  void run_if_any(const Statement& s) {
    const Bits holds = condition(s);
    const Bits outer = enabled_;
    issue(Class::enable);
    issue(Class::reduce);
    enabled_ = both(outer, holds);
    if (lanes() > 0) region([&] { run(s.body); });
    issue(Class::enable);
    enabled_ = outer;
  }

  void run_loop(const Statement& s) {
    const int passes = kVariables + s.loop_depth;
    issue(Class::int32_alu);
    assign(passes, [&](std::size_t pe) { return variable(s.left, pe) & 3; });
    const Bits outer = enabled_;
    issue(Class::enable);
    for (bool again = true; again;) {
      region([&] {
        issue(Class::int32_alu);
        issue(Class::reduce);
        for (std::size_t pe = 0; pe < enabled_.size(); ++pe)
          enabled_[pe] = enabled_[pe] && variable(passes, pe) > 0;
        again = lanes() > 0;
        if (!again) return;
        region([&] {
          issue(Class::int32_alu);
          assign(passes, [&](std::size_t pe) { return variable(passes, pe) - 1; });
          run(s.body);
        });
      });
    }
    issue(Class::enable);
    enabled_ = outer;
  }

  void run(const Statement& s) {
    switch (s.kind) {
      case Statement::Kind::assign:
        issue(Class::int32_mul);
        issue(Class::int32_alu, 2);
        assign(s.target, [&](std::size_t pe) {
          const auto product = std::uint32_t(variable(s.left, pe)) * 3u;
          return static_cast<std::int32_t>(product + std::uint32_t(variable(s.right, pe)) +
                                           std::uint32_t(s.constant));
        });
        break;
      case Statement::Kind::if_any:
        run_if_any(s);
        break;
      case Statement::Kind::loop:
        run_loop(s);
        break;
      default:
        run_if(s);
    }
  }

  Outcome outcome_;
  Bits enabled_;
  std::uint64_t region_lanes_ = 0;
};

}  // namespace test_support
