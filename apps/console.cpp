#include "apps/console.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

namespace vultus::apps {
namespace {

volatile std::sig_atomic_t received_signal = 0;

extern "C" void remember_signal(int signal) {
  received_signal = signal;
  std::signal(signal, SIG_DFL);
}

std::string minutes(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  char text[32];
  std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  return text;
}

double seconds_between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

constexpr double terminal_interval = 0.1, plain_interval = 10.0;  // s

}  // namespace

int stop_signal() { return received_signal; }

Console::Console(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {
  std::signal(SIGINT, remember_signal);
  std::signal(SIGTERM, remember_signal);
}

Console::~Console() { finish(); }

void Console::begin(std::string_view stage, std::size_t total) {
  const std::lock_guard lock(mutex_);
  end_stage();
  stage_ = stage;
  total_ = total;
  done_ = 0;
  stage_start_ = last_drawn_ = Clock::now();
  if (terminal_) draw(stage_start_);
}

void Console::advance(std::size_t steps) {
  done_ += steps;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;
  const auto now = Clock::now();
  if (seconds_between(last_drawn_, now) >= (terminal_ ? terminal_interval : plain_interval)) draw(now);
}

void Console::note(std::string_view line) {
  const std::lock_guard lock(mutex_);
  notes_.emplace_back(line);
  say(line);
}

void Console::warn(std::string_view line) {
  const std::lock_guard lock(mutex_);
  warnings_.emplace_back(line);
  say("warning: " + std::string(line));
}

bool Console::cancelled() const { return received_signal != 0; }

void Console::finish() {
  const std::lock_guard lock(mutex_);
  end_stage();
}

void Console::end_stage() {
  if (stage_.empty()) return;
  const double seconds = seconds_between(stage_start_, Clock::now());
  if (!timings_.empty() && timings_.back().stage == stage_)
    timings_.back().seconds += seconds;
  else
    timings_.push_back({stage_, seconds});
  char text[32];
  std::snprintf(text, sizeof text, " (%.1f s)", seconds);
  say(stage_ + text);
  stage_.clear();
}

void Console::say(std::string_view line) {
  if (quiet_) return;
  std::fprintf(stderr, terminal_ ? "\r\x1b[K%.*s\n" : "%.*s\n", static_cast<int>(line.size()), line.data());
}

void Console::draw(Clock::time_point now) {
  last_drawn_ = now;
  if (quiet_ || stage_.empty()) return;
  if (!terminal_ && total_ > 0 && done_ >= total_) return;  // the line of the stage's end says it
  const std::size_t done = std::min<std::size_t>(done_, total_ == 0 ? done_.load() : total_);
  std::string line = stage_;
  if (total_ > 0) {
    const double share = static_cast<double>(done) / static_cast<double>(total_);
    const double elapsed = seconds_between(stage_start_, now);
    constexpr int width = 24;
    const auto filled = static_cast<std::size_t>(share * width);
    if (terminal_) line += " [" + std::string(filled, '#') + std::string(width - filled, '.') + "]";
    line += " " + std::to_string(static_cast<int>(100.0 * share)) + " %";
    if (done > 0) line += ", " + minutes(elapsed * (1.0 - share) / share) + " left";
  } else if (done > 0) {
    line += " " + std::to_string(done);
  }
  std::fprintf(stderr, terminal_ ? "\r\x1b[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
}

}  // namespace vultus::apps
