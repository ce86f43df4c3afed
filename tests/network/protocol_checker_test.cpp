// The checker that other tests trust: it must catch each rule when it is broken.

#include "tests/support/protocol_checker.hpp"

#include "model/transaction/payload_pool.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace protocol_checker_test {

using Payload = tlm::tlm_generic_payload;
using tlm::BEGIN_REQ;
using tlm::BEGIN_RESP;
using tlm::END_REQ;
using tlm::END_RESP;

/// Calls what the test says, in either direction.
struct Puppets : sc_core::sc_module {
  tlm_utils::simple_initiator_socket<Puppets> initiator{"initiator"};
  tlm_utils::simple_target_socket<Puppets> target{"target"};
  explicit Puppets(const sc_core::sc_module_name& name) : sc_module(name) {
    initiator.register_nb_transport_bw(this, &Puppets::take);
    target.register_nb_transport_fw(this, &Puppets::take);
  }
  tlm::tlm_sync_enum answer = tlm::TLM_ACCEPTED;
  tlm::tlm_phase answer_phase;

 private:
  tlm::tlm_sync_enum take(Payload&, tlm::tlm_phase& phase, sc_core::sc_time&) {
    if (answer == tlm::TLM_UPDATED) phase = answer_phase;
    return answer;
  }
};

class ProtocolChecker : public test_support::SystemCFixture {
 protected:
  ProtocolChecker() {
    puppets.initiator.bind(checker.in);
    checker.out.bind(puppets.target);
    elaborate();
  }
  void forward(Payload& payload, tlm::tlm_phase phase, double delay_ns = 0) {
    sc_core::sc_time delay(delay_ns, sc_core::SC_NS);
    puppets.initiator->nb_transport_fw(payload, phase, delay);
  }
  void backward(Payload& payload, tlm::tlm_phase phase, double delay_ns = 0) {
    if (phase == BEGIN_RESP) payload.set_response_status(tlm::TLM_OK_RESPONSE);
    sc_core::sc_time delay(delay_ns, sc_core::SC_NS);
    puppets.target->nb_transport_bw(payload, phase, delay);
  }
  Payload& payload() { return pool.take(tlm::TLM_READ_COMMAND, 0, 64); }
  void expect_violation(const std::string& rule) {
    EXPECT_EQ(checker.violations(), std::vector<std::string>{rule});
  }

  test_support::ProtocolChecker checker{"checker"};
  Puppets puppets{"puppets"};
  model::PayloadPool pool;
};

TEST_F(ProtocolChecker, FourPhasesInOrderAreFine) {
  Payload& one = payload();
  Payload& two = payload();
  forward(one, BEGIN_REQ);
  backward(one, END_REQ);
  forward(two, BEGIN_REQ);
  backward(one, BEGIN_RESP);
  backward(two, END_REQ);
  forward(one, END_RESP);
  backward(two, BEGIN_RESP);
  forward(two, END_RESP);
  EXPECT_EQ(checker.violations(), std::vector<std::string>{});
  EXPECT_EQ(checker.transactions(), 2u);
  EXPECT_EQ(checker.most_active(), 2u);
  EXPECT_EQ(checker.active(), 0u);
}

TEST_F(ProtocolChecker, ShortCutsAreFine) {
  Payload& one = payload();
  forward(one, BEGIN_REQ);
  backward(one, BEGIN_RESP);  // implies END_REQ
  forward(one, END_RESP);
  one.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  puppets.answer = tlm::TLM_UPDATED;
  puppets.answer_phase = END_REQ;
  forward(one, BEGIN_REQ);
  puppets.answer_phase = END_RESP;
  backward(one, BEGIN_RESP);
  EXPECT_EQ(checker.violations(), std::vector<std::string>{});
  EXPECT_EQ(checker.active(), 0u);
}

TEST_F(ProtocolChecker, SecondRequestBeforeTheFirstIsEnded) {
  forward(payload(), BEGIN_REQ);
  forward(payload(), BEGIN_REQ);
  expect_violation("one request at a time");
}

TEST_F(ProtocolChecker, RequestBeforeTheAnnotatedEndOfTheOneBefore) {
  Payload& one = payload();
  forward(one, BEGIN_REQ);
  backward(one, END_REQ, 5);
  forward(payload(), BEGIN_REQ, 4);
  expect_violation("one request at a time");
}

TEST_F(ProtocolChecker, SecondResponseBeforeTheFirstIsEnded) {
  Payload& one = payload();
  Payload& two = payload();
  for (Payload* each : {&one, &two}) {
    forward(*each, BEGIN_REQ);
    backward(*each, END_REQ);
  }
  backward(one, BEGIN_RESP);
  backward(two, BEGIN_RESP);
  expect_violation("one response at a time");
}

TEST_F(ProtocolChecker, EndReqTwice) {
  Payload& one = payload();
  forward(one, BEGIN_REQ);
  backward(one, END_REQ);
  backward(one, END_REQ);
  expect_violation("END_REQ follows BEGIN_REQ");
}

TEST_F(ProtocolChecker, EndRespWithoutAResponse) {
  Payload& one = payload();
  forward(one, BEGIN_REQ);
  backward(one, END_REQ);
  forward(one, END_RESP);
  expect_violation("END_RESP follows BEGIN_RESP");
}

TEST_F(ProtocolChecker, ResponseTwice) {
  Payload& one = payload();
  forward(one, BEGIN_REQ);
  backward(one, BEGIN_RESP);
  forward(one, END_RESP);
  backward(one, BEGIN_RESP);
  ASSERT_FALSE(checker.violations().empty());
  EXPECT_EQ(checker.violations().front(), "a response answers a request");
}

TEST_F(ProtocolChecker, ResponseWithoutAStatus) {
  Payload& one = payload();
  forward(one, BEGIN_REQ);
  tlm::tlm_phase phase = BEGIN_RESP;
  sc_core::sc_time delay;
  puppets.target->nb_transport_bw(one, phase, delay);
  expect_violation("a response has a status");
}

TEST_F(ProtocolChecker, PhaseBeforeTheOneBefore) {
  Payload& one = payload();
  forward(one, BEGIN_REQ, 10);
  backward(one, END_REQ, 5);
  expect_violation("phases of a transaction do not go back in time");
}

TEST_F(ProtocolChecker, PayloadWithoutAMemoryManager) {
  Payload one;
  forward(one, BEGIN_REQ);
  expect_violation("a payload has a memory manager and is alive");
}

TEST_F(ProtocolChecker, PayloadInTwoTransactions) {
  Payload& one = payload();
  forward(one, BEGIN_REQ);
  backward(one, END_REQ);
  forward(one, BEGIN_REQ);
  expect_violation("a payload is in one transaction at a time");
}

TEST_F(ProtocolChecker, PhaseInTheWrongDirection) {
  Payload& one = payload();
  forward(one, BEGIN_REQ);
  forward(one, END_REQ);
  expect_violation("forward phases are BEGIN_REQ and END_RESP");
}

}  // namespace protocol_checker_test
