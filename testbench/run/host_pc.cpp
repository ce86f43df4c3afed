#include "testbench/run/host_pc.hpp"

#include "firmware/path_tracer/pipeline/results_handover.hpp"
#include "model/transaction/payload.hpp"

namespace testbench {

using path_tracer::HostSemaphores;

HostPc::HostPc(const sc_core::sc_module_name& name, model::Csx600& chip, model::ControlUnit& control_unit,
               const MonoImage& image, Film& film, const HostPc* uploads_scene)
    : sc_module(name),
      chip_(chip),
      control_unit_(control_unit),
      uploads_scene_(uploads_scene),
      image_(image),
      results_(image.layout, film) {
  control_unit_.host_semaphores().share(HostSemaphores::kResultsReady);
  control_unit_.host_semaphores().share(HostSemaphores::kResultsFree);
  control_unit_.host_semaphores().on_untimed_signal([this] { fetch_untimed_results(); });
  SC_HAS_PROCESS(HostPc);
  SC_THREAD(run);
}

void HostPc::wait_until(model::Cycles cycle) {
  const sc_core::sc_time target = chip_.clock.time_at(cycle);
  if (target > sc_core::sc_time_stamp()) wait(target - sc_core::sc_time_stamp());
}

void HostPc::upload() {
  if (uploads_scene_ == nullptr) {
    wait_until(chip_.host_link.upload(0, image_.bytes.data(), image_.bytes.size(), now()));
    scene_is_there_ = true;
    scene_came_.notify(sc_core::SC_ZERO_TIME);
  } else if (!uploads_scene_->scene_is_there_) {
    wait(uploads_scene_->scene_came_);
  }
  if (!image_.camera_samples.empty())
    wait_until(chip_.host_link.upload(image_.layout.camera_samples.address, image_.camera_samples.data(),
                                      image_.camera_sample_bytes(), now()));
}

void HostPc::run() {
  upload();
  control_unit_.start();
  while (true) {
    while (control_unit_.host_semaphores().try_wait(HostSemaphores::kResultsReady)) fetch_results();
    if (control_unit_.finished()) break;
    wait(control_unit_.host_semaphores().firmware_signalled() | control_unit_.finished_event());
  }
  finished_cycle_ = now();
  finished_ = true;
}

void HostPc::fetch_results() {
  results_.fetch([this](cn::MonoAddress from, void* to, std::size_t bytes) {
    if (checker_ != nullptr) checker_->host_touches_mono(cn::Access::read, {from, bytes});
    wait_until(chip_.host_link.download(from, to, bytes, now()));
  });
  control_unit_.host_semaphores().signal(HostSemaphores::kResultsFree);
}

/// Fetches results without taking time: those of a program that is timed without radiance are no part of the
/// run.
void HostPc::fetch_untimed_results() {
  results_.fetch([this](cn::MonoAddress from, void* to, std::size_t bytes) {
    tlm::tlm_generic_payload transaction;
    model::set_access(transaction, tlm::TLM_READ_COMMAND, from, static_cast<unsigned char*>(to), bytes);
    chip_.host_link.socket->transport_dbg(transaction);
  });
}

}  // namespace testbench
