// Two ranks talk here: the first of those with the surfaces, and the first of those that share the liquid.
// After the first news, of the start, the one orders and the other answers with news.
#include "tools/runs/distant_liquid.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/errors.h"
#include "core/state_bytes.h"
#include "solver/broadcast_state.h"
#include "tools/runs/near_liquid.h"

namespace kappaflow {

// What goes from one rank to the other, see core/saved_state.h: of a step what Simulation and its watch ask.
template <class Archive>
void serialize(Archive& archive, FluidStep& step) {
  archive(step.time_step, step.density_iterations, step.divergence_iterations, step.viscosity_iterations,
          step.viscosity_error, step.density_error_mean, step.density_error_max, step.fastest);
}
template <class Archive>
void serialize(Archive& archive, LiquidStep& step) {
  archive(step.last, step.seconds, step.surfaces_follow, step.now);
}
template <class Archive>
void serialize(Archive& archive, BodyState& body) {
  archive(body.pose.rotation, body.pose.translation, body.velocity.point, body.velocity.linear,
          body.velocity.angular);
}
template <class Archive>
void serialize(Archive& archive, ParticleFrame& frame) {
  archive(frame.particles, frame.density, frame.pressure, frame.source, frame.temperature);
}
template <class Archive>
void serialize(Archive& archive, Compression& compression) {
  archive(compression.mean, compression.max);
}
template <class Archive>
void serialize(Archive& archive, TemperatureRange& range) {
  archive(range.min, range.mean, range.max);
}
template <class Archive>
void serialize(Archive& archive, LiquidRecord& record) {
  archive(record.particles, record.count, record.pieces, record.compression, record.temperature, record.taken,
          record.bodies);
}

namespace {

constexpr int kSurfaces = 0;  // the first rank with them

enum class Order : std::int64_t {
  write,    // the particles at t = 0
  begin,    // from there
  restore,  // from the state that follows
  go_on,    // send the next news
  save,     // and the state with it; at t = 0 the state alone
  end
};

/// What the liquid's rank tells of a step.
struct News {
  double time = 0;
  std::size_t steps = 0;
  LiquidStep step;
  std::string failure;  // empty: none
  int exit_code = 0;    // of the failure
  std::optional<LiquidRecord> record;
  bool is_saved = false;  // whether the state follows, by itself: it is large

  template <class Archive>
  void serialize(Archive& archive) {
    archive(time, steps, step, failure, exit_code, record, is_saved);
  }
};

void send(Ranks& ranks, int to, std::string text) {
  std::uint64_t size = text.size();
  ranks.exchange_asleep(std::array{Parcel{to, bytes_in(std::span(&size, 1))}}, {});
  ranks.exchange(std::array{Parcel{to, bytes_in(std::span(text))}}, {});
}

std::string receive(Ranks& ranks, int from) {
  std::uint64_t size = 0;
  ranks.exchange_asleep({}, std::array{Parcel{from, bytes_in(std::span(&size, 1))}});
  std::string text(size, '\0');
  ranks.exchange({}, std::array{Parcel{from, bytes_in(std::span(text))}});
  return text;
}

template <class... Values>
void send_values(Ranks& ranks, int to, const Values&... values) {
  send(ranks, to, state_bytes(values...));
}

template <class... Values>
void receive_values(Ranks& ranks, int from, Values&... values) {
  read_state_bytes(receive(ranks, from), values...);
}

Order next_order(Ranks& ranks) {
  Order order = Order::end;
  receive_values(ranks, kSurfaces, order);
  return order;
}

News failure_of(const Error& error) {
  News news;
  news.failure = error.what();
  news.exit_code = error.exit_code();
  return news;
}

/// The liquid's part of the conversation.
class LiquidServer {
 public:
  LiquidServer(const Scene& scene, Ranks& ranks) : scene_(scene), ranks_(ranks) {}

  /// ranks: that share the liquid, or nullptr. all: whether all particles are told.
  void serve(PreparedScene& prepared, Ranks* ranks, bool all) {
    std::unique_ptr<Liquid> liquid;
    try {
      if (all)
        liquid = own_liquid(prepared, ranks);
      else
        liquid = std::make_unique<NearLiquid>(scene_, make_fluid(prepared, ranks), ranks);
    } catch (const InvalidInput& error) {
      return tell(failure_of(error));
    } catch (const SolverFailure& error) {
      return tell(failure_of(error));
    }
    tell(news_of(*liquid, true, false));
    if (begin(*liquid)) run(*liquid);
  }

 private:
  /// Returns whether to go on.
  bool begin(Liquid& liquid) {
    Order order = next_order(ranks_);
    for (; order == Order::write || order == Order::save; order = next_order(ranks_)) {
      if (order == Order::write) write_first(liquid);
      if (order == Order::save) send(ranks_, kSurfaces, state_of(liquid));
    }
    if (order == Order::end) return false;
    receive_values(ranks_, kSurfaces, folder_);
    if (order == Order::begin) return true;
    receive_values(ranks_, kSurfaces, liquid.pace());
    read_bytes(receive(ranks_, kSurfaces), [&](StateReader& archive) { liquid.read_state(archive); });
    return true;
  }

  /// The particles at t = 0, and says what came of it.
  void write_first(Liquid& liquid) {
    std::string folder;
    receive_values(ranks_, kSurfaces, folder);
    News news;
    try {
      liquid.write_particles(folder, 0);
    } catch (const IoError& error) {
      news = failure_of(error);
    }
    tell(std::move(news));
  }

  void run(Liquid& liquid) {
    const int last = last_frame_of(scene_);
    int frame = 0;
    while (frame < last) {
      if (is_reached(liquid.time(), frame_time(scene_, frame + 1))) {
        ++frame;
        continue;
      }
      News news = next(liquid, frame + 1);
      const Order order = next_order(ranks_);
      if (order == Order::end) return;
      const bool failed = !news.failure.empty();
      const bool is_saved = !failed && (news.is_saved || order == Order::save);
      news.is_saved = is_saved;
      tell(std::move(news));
      if (is_saved) send(ranks_, kSurfaces, state_of(liquid));
      if (failed) break;
    }
    next_order(ranks_);  // nothing comes but the end
  }

  /// As far as the surfaces may wait, or to the frame.
  News next(Liquid& liquid, int frame) {
    const double until = frame_time(scene_, frame);
    LiquidStep all;
    try {
      do {
        add(liquid.step(until, false), all);
      } while (!all.surfaces_follow);
    } catch (const SolverFailure& error) {
      News news = failure_of(error);
      if (liquid.can_be_asked()) news.record = liquid.record();
      return news;
    }
    const bool in_frame = is_reached(liquid.time(), until);
    try {
      if (in_frame) liquid.write_particles(folder_, frame);
    } catch (const IoError& error) {
      return failure_of(error);
    }
    News news = news_of(liquid, in_frame, is_saved_here(liquid, frame));
    news.step = std::move(all);
    return news;
  }

  /// Whether one of the frames that are reached, of which `frame` is the first, has a checkpoint.
  bool is_saved_here(const Liquid& liquid, int frame) const {
    for (; frame <= last_frame_of(scene_) && is_reached(liquid.time(), frame_time(scene_, frame)); ++frame)
      if (has_checkpoint(scene_, frame)) return true;
    return false;
  }

  static void add(LiquidStep step, LiquidStep& all) {
    const FluidStep before = all.last;
    step.seconds += all.seconds;
    step.last.density_error_mean = std::max(step.last.density_error_mean, before.density_error_mean);
    step.last.density_error_max = std::max(step.last.density_error_max, before.density_error_max);
    step.last.viscosity_error = std::max(step.last.viscosity_error, before.viscosity_error);
    all = std::move(step);
  }

  static News news_of(Liquid& liquid, bool in_frame, bool is_saved) {
    News news;
    news.time = liquid.time();
    news.steps = liquid.steps();
    if (in_frame) news.record = liquid.record();
    news.is_saved = is_saved;
    return news;
  }

  static std::string state_of(Liquid& liquid) {
    return bytes_written([&](StateWriter& archive) { liquid.write_state(archive); });
  }

  void tell(News news) {
    std::string bytes = state_bytes(news);
    news = {};  // large
    send(ranks_, kSurfaces, std::move(bytes));
  }

  const Scene& scene_;
  Ranks& ranks_;
  std::string folder_;  // of the run
};

/// What the others of those that share it do.
void follow_liquid(PreparedScene& prepared, Ranks& ranks) {
  FluidSolver fluid = make_fluid(prepared, &ranks);
  LiquidPart part(prepared.scene, fluid, &ranks);
  for (RankOrder order = fluid.follow(); order.task != RankTask::end; order = fluid.follow())
    part.follow(order);
}

}  // namespace

RanksApart set_apart(Ranks& all, int surfaces, bool is_near) {
  if (all.rank() == 0) all.announce({RankTask::serve});
  broadcast_state(all, surfaces, is_near);
  return {all, surfaces, is_near, all.part(surfaces)};
}

DistantLiquid::DistantLiquid(const PreparedScene& prepared, RanksApart ranks, std::filesystem::path folder)
    : Liquid(prepared.scene), prepared_(prepared), ranks_(std::move(ranks)), folder_(std::move(folder)) {
  News news;
  read_state_bytes(hear(), news);
  ranks_.all.finish();
  if (surface_ranks() != nullptr) surface_ranks()->finish();
  if (!news.failure.empty()) {
    end_others();
    throw_told(news.failure, news.exit_code);
  }
  record_ = std::move(*news.record);
}

DistantLiquid::~DistantLiquid() {
  if (!is_first()) return;
  if (surface_ranks() != nullptr && surface_ranks()->busy()) ranks_.all.start();
  if (ranks_.all.busy()) return;  // out of step with the others: the program ends them all
  end_others();
  try {
    send_values(ranks_.all, teller(), Order::end);
  } catch (const std::exception&) {  // else the others would wait for ever
    ranks_.all.abort(1);
  }
}

void DistantLiquid::end_others() {
  if (is_first() && surface_ranks() != nullptr) surface_ranks()->announce({RankTask::end});
}

/// What the liquid tells next, on all ranks with surfaces; the others sleep until it comes.
std::string DistantLiquid::hear() {
  Ranks* const others = surface_ranks();
  if (!is_first() && others->next_order().task != RankTask::hear)
    throw std::logic_error("ranks that follow surfaces are out of step");
  std::string text = is_first() ? receive(ranks_.all, teller()) : std::string();
  if (others == nullptr) return text;
  if (is_first()) others->announce({RankTask::hear});
  others->broadcast_values(text);
  return text;
}

void DistantLiquid::begin() {
  send_values(ranks_.all, teller(), restored_ ? Order::restore : Order::begin);
  send_values(ranks_.all, teller(), folder_.string());
  if (!restored_) return;
  send_values(ranks_.all, teller(), pace());
  send(ranks_.all, teller(), std::move(saved_));
  pace().follow();  // from here on the others keep it
}

LiquidStep DistantLiquid::step(double /*until*/, bool last) {
  if (is_first()) {
    ranks_.all.start();
    if (!begun_) begin();
    send_values(ranks_.all, teller(), last ? Order::save : Order::go_on);
  }
  begun_ = true;
  News news;
  read_state_bytes(hear(), news);
  std::string().swap(saved_);  // large
  is_saved_ = news.is_saved;
  if (is_first() && is_saved_) saved_ = receive(ranks_.all, teller());
  ranks_.all.finish();
  if (!news.record) news.record.emplace().particles.particles = news.step.now;
  record_ = std::move(*news.record);
  if (!news.failure.empty()) throw_told(news.failure, news.exit_code);
  time_ = news.time;
  steps_ = news.steps;
  return std::move(news.step);
}

/// After the start the others have written them before they told of the frame.
void DistantLiquid::write_particles(const std::filesystem::path& folder, int /*frame*/) {
  if (tells_all() || begun_) return;
  ranks_.all.start();
  send_values(ranks_.all, teller(), Order::write);
  send_values(ranks_.all, teller(), std::filesystem::absolute(folder).string());
  News news;
  receive_values(ranks_.all, teller(), news);
  ranks_.all.finish();
  if (!news.failure.empty()) throw_told(news.failure, news.exit_code);
}

void DistantLiquid::write_state(StateWriter& archive) {
  constexpr std::size_t kOrderOfBytes = 1;  // that an archive begins with
  if (!begun_ && saved_.empty()) {          // at the start
    ranks_.all.start();
    send_values(ranks_.all, teller(), Order::save);
    saved_ = receive(ranks_.all, teller());
    ranks_.all.finish();
  }
  archive(cereal::binary_data(saved_.data() + kOrderOfBytes, saved_.size() - kOrderOfBytes));
}

void DistantLiquid::read_state(StateReader& archive) {
  if (!is_first()) {
    archive(time_, steps_);
    return;
  }
  SavedFluid saved = FluidSolver::take_saved(archive, prepared_.scene.fluid, prepared_.bodies);
  time_ = saved.time;
  steps_ = saved.steps;
  saved_ = std::move(saved.bytes);
  record_ = {};
  restored_ = true;
}

void serve_liquid(PreparedScene prepared, RanksApart ranks) {
  Ranks* const shared = ranks.part->size() > 1 ? ranks.part.get() : nullptr;
  if (ranks.part->rank() == 0) {
    LiquidServer(prepared.scene, ranks.all).serve(prepared, shared, !ranks.is_near);
    if (shared != nullptr) shared->announce({RankTask::end});
  } else if (shared->next_order().task == RankTask::make) {
    follow_liquid(prepared, *shared);
  }
}

}  // namespace kappaflow
