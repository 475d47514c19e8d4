// Unknowns, observations, optimisers.
#include <regex>

#include "deck/describe_inverse.hpp"

namespace jaxmpm::deck {

using described::Place;
using described::shown_number;

described::EnumNames<Transform> names_of(Transform) {
  return {{Transform::none, "none"}, {Transform::log, "log"}, {Transform::logit, "logit"}};
}

namespace {

void check_bounds(const Unknown& u, const Place& place) {
  const bool bounded = u.bounds.has_value();
  if (bounded && !((*u.bounds)[0] < (*u.bounds)[1])) place.problem("bounds", "must be the lower and the upper one, in this order");
  if (u.transform == Transform::logit && !bounded) place.problem("transform", "\"logit\" needs bounds; give them, or choose none or log");
  if (u.transform == Transform::log && bounded && (*u.bounds)[0] < 0)
    place.problem("bounds", "must not be negative with transform \"log\"");
}

void check_start(const Unknown& u, const Place& place) {
  if (const auto* value = std::get_if<double>(&u.start)) check_start_value(u, *value, "", place);
  if (const auto* values = std::get_if<Numbers>(&u.start))
    for (const double value : *values) check_start_value(u, value, "", place);
}

/// Keys that all kinds of observation share.
template <class T>
void describe_observed(Description<T>& d) {
  const auto own = [](auto Observed::*member) {
    return static_cast<std::remove_reference_t<decltype(std::declval<T&>().*member)> T::*>(member);
  };
  d.required("file", own(&Observed::file)).items(1).help("results.h5, or CSV with # comments and a header, looked for beside the deck.");
  d.optional("from_time", own(&Observed::from_time))
      .unit("s")
      .from(0)
      .otherwise("the first of the file")
      .help("Earlier rows are left out.");
  d.optional("to_time", own(&Observed::to_time)).unit("s").from(0).otherwise("the end").help("Later rows are left out.");
  d.optional("every", own(&Observed::every)).unit("s").above(0).otherwise("every row").help("Time between the rows that count.");
  d.optional("average", own(&Observed::average))
      .unit("s")
      .above(0)
      .word("none")
      .help("Means over windows of this length, counted from the first row that counts, are compared instead of single rows.");
  d.optional("weight", own(&Observed::weight)).above(0).help("In the loss.");
  d.optional("noise", own(&Observed::noise)).word("none").help("Added to the observed values.");
  d.optional("mask", own(&Observed::mask)).help("What counts: \"none\", the name of a CSV column, or a box.");
  d.check({"from_time", "to_time"}, [](const T& o, const Place& place) {
    if (o.from_time && o.to_time && *o.from_time > *o.to_time) place.problem("to_time", "must not be before from_time");
  });
}

template <class T>
void describe_stopping(Description<T>& d) {
  d.optional("iterations", &T::iterations).from(1).help("At most.");
  d.optional("tolerance", &T::tolerance).above(0).below(1).word("none").help("Ends when the loss falls by less than this part of itself.");
}

bool is_amount(const std::string& text) {
  static const std::regex pattern("[0-9]{1,9}(\\.[0-9]{1,9})? ?(MiB|GiB|TiB)");
  return std::regex_match(text, pattern);
}

void check_room(const Inverse& inverse, const Place& place) {
  if (!is_amount(inverse.memory))
    place.problem("memory", "expected an amount such as \"4 GiB\" (MiB, GiB or TiB), found \"" + inverse.memory + "\"");
  if (inverse.disk != "none" && !is_amount(inverse.disk))
    place.problem("disk", "expected \"none\" or an amount such as \"50 GiB\" (MiB, GiB or TiB), found \"" + inverse.disk + "\"");
}

}  // namespace

void check_start_value(const Unknown& u, double value, const std::string& what, const Place& place) {
  const std::string shown = what + shown_number(value);
  if (u.transform == Transform::log && !(value > 0)) place.problem("start", shown + " is not above 0, as transform \"log\" needs");
  else if (u.bounds && (value < (*u.bounds)[0] || value > (*u.bounds)[1]))
    place.problem("start", shown + " is outside of bounds, " + shown_number((*u.bounds)[0]) + " to " + shown_number((*u.bounds)[1]) +
                               "; move one of them");
  else if (u.transform == Transform::logit && u.bounds && (value == (*u.bounds)[0] || value == (*u.bounds)[1]))
    place.problem("start", shown + " is a bound, which transform \"logit\" reaches only at infinity; start within");
}

void describe(Description<Prior>& d) {
  d.is("prior", "Gaussian prior of an unknown.");
  d.optional("mean", &Prior::mean).word("start").help("A number, or where the search starts, value by value.");
  d.required("deviation", &Prior::deviation).above(0).help("Standard deviation.");
}

void describe(Description<Unknown>& d) {
  d.is("unknown", "A number of the deck that is to be found.");
  d.required("path", &Unknown::path).items(2).help("JSON pointer; * stands for every key or index at its place.");
  d.optional("start", &Unknown::start).otherwise("the deck's value").help("A number, or a list in the order of the pointers.");
  d.optional("bounds", &Unknown::bounds).items(2, 2).word("none").help("Lower and upper one.");
  d.optional("transform", &Unknown::transform).help("The optimiser works on the number, its logarithm, or its logit within the bounds.");
  d.optional("share", &Unknown::share).help("One value for all pointers.");
  d.optional("prior", &Unknown::prior).word("none");
  d.check({"path"}, [](const Unknown& u, const Place& place) {
    if (u.path[0] != '/') place.problem("path", "a JSON pointer starts with /");
  });
  d.check({"bounds", "transform"}, check_bounds);
  d.check({"start", "bounds", "transform"}, check_start);
}

void describe(Description<RandomSelection>& d) {
  d.is("random", "Some particles, drawn at random.", "select");
  d.required("random", &RandomSelection::random).from(1).help("How many.");
  d.optional("seed", &RandomSelection::seed).from(0);
}
void describe(Description<IdSelection>& d) {
  d.is("ids", "Particles by id.", "select");
  d.required("ids", &IdSelection::ids).from(0).items(1).distinct();
}
void describe(Description<Noise>& d) {
  d.is("noise", "Gaussian noise.");
  d.required("deviation", &Noise::deviation).above(0).help("Standard deviation, in the unit of what is observed.");
  d.optional("seed", &Noise::seed).from(0);
}

void describe(Description<ParticlesObservation>& d) {
  d.is("particles", "A field of particles. CSV: time,id,x,y[,z][,sigma] or time,id,vx,vy[,vz][,sigma].", "observation");
  d.required("body", &ParticlesObservation::body);
  d.required("field", &ParticlesObservation::field).choices({"position", "velocity"});
  d.optional("select", &ParticlesObservation::select).help("\"all\", {random, seed} or {ids}.");
  describe_observed(d);
}
void describe(Description<GaugeObservation>& d) {
  d.is("gauge", "Values of a gauge of the deck. CSV: time,value[,sigma], or value_x,value_y,… for the components of a vector.",
       "observation");
  d.required("gauge", &GaugeObservation::gauge);
  describe_observed(d);
}
described::EnumNames<ProfileReading> names_of(ProfileReading) {
  return {{ProfileReading::surface, "surface"}, {ProfileReading::depth, "depth"}};
}

void describe(Description<ProfileObservation>& d) {
  d.is("profile",
       "Heights of a body's deposit. CSV: x[,y],height[,sigma]. results.h5: the middle of each cell; its frames need the density.",
       "observation");
  d.required("body", &ProfileObservation::body);
  d.optional("reading", &ProfileObservation::reading)
      .help(
          "How the run's heights are read: \"surface\" as a height gauge does, from where the material fills half of the space; \"depth\" "
          "from the volume of all material above the ground. Both agree for a heap without hollows; the depth is smooth in the particles' "
          "places, so that the loss has a useful gradient.");
  d.optional("time", &ProfileObservation::time).unit("s").from(0).word("end");
  describe_observed(d);
}

void describe(Description<Adam>& d) {
  d.is("adam", "Gradient descent with adaptive moments.", "optimizer");
  d.optional("learning_rate", &Adam::learning_rate)
      .above(0)
      .help("How far a number (or its logarithm or logit) moves in the first iteration, in its own unit.");
  d.optional("decay", &Adam::decay).above(0).to(1).help("Factor on the learning rate after each iteration.");
  describe_stopping(d);
}
void describe(Description<Lbfgs>& d) {
  d.is("lbfgs", "Quasi-Newton method of limited memory, with bounds. Each gradient counts as an iteration, also those of line searches.",
       "optimizer");
  d.optional("memory", &Lbfgs::memory).from(1).to(1000).help("Pairs of vectors kept.");
  describe_stopping(d);
}
void describe(Description<GaussNewton>& d) {
  d.is("gauss_newton",
       "Damped Gauss–Newton method with differences of forward runs: for few unknowns, as each iteration takes two runs for each of them.",
       "optimizer");
  d.optional("spacing", &GaussNewton::spacing)
      .from(1e-4)
      .to(0.25)
      .help(
          "Of the differences at first, in parts of the width of the bounds (of the start's size without them). It follows the steps as "
          "they become shorter, down to 1e-4. A loss may be rough on closer scales.");
  describe_stopping(d);
}

void describe(Description<Inverse>& d) {
  d.is("inverse", "Unknowns of the deck and the observations they are to explain.");
  d.required("unknowns", &Inverse::unknowns).items(1);
  d.required("observations", &Inverse::observations).items(1);
  d.optional("optimizer", &Inverse::optimizer).otherwise("adam with its own defaults").help("Chosen by `method`.");
  d.optional("memory", &Inverse::memory).help("For checkpoints of the gradient: a number and MiB, GiB or TiB.");
  d.optional("disk", &Inverse::disk)
      .help("\"none\", or room for more checkpoints in the output directory, once memory is full: a number and MiB, GiB or TiB.");
  d.check({"memory", "disk"}, check_room);
}

namespace {
Inverse read_inverse(const Place& place) {
  Inverse inverse;
  described::Codec<Inverse>::read(inverse, place, {});
  return inverse;
}
}  // namespace

void InverseText::read(std::string& out, const Place& place, const described::Limits& limits) {
  out = described::Codec<Inverse>::write(read_inverse(place), limits).dump(2);
}
described::Json InverseText::write(const std::string& in, const described::Limits&) {
  return in.empty() ? described::Json(described::Json::value_t::discarded) : described::Json::parse(in);
}
described::Json InverseText::schema(const described::Limits& limits, described::Schema& defs) {
  return described::Codec<Inverse>::schema(limits, defs);
}

}  // namespace jaxmpm::deck
