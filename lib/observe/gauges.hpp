#pragma once
// The registry: one line for each kind of gauge. The kind's documentation for users is in the deck's describe().
#include "deck/inverse.hpp"
#include "observe/gauge.hpp"

namespace jaxmpm {

std::unique_ptr<Gauge> make_gauge(const deck::FrontGauge& gauge, const Model& model);
std::unique_ptr<Gauge> make_gauge(const deck::RegionMeanGauge& gauge, const Model& model);
std::unique_ptr<Gauge> make_gauge(const deck::HeightGauge& gauge, const Model& model);
std::unique_ptr<Gauge> make_gauge(const deck::PressureGauge& gauge, const Model& model);
std::unique_ptr<Gauge> make_gauge(const deck::ForceGauge& gauge, const Model& model);
std::unique_ptr<Gauge> make_gauge(const deck::EnergyGauge& gauge, const Model& model);
std::unique_ptr<Gauge> make_gauge(const deck::MomentumGauge& gauge, const Model& model);
std::unique_ptr<Gauge> make_gauge(const deck::ParticlesGauge& gauge, const Model& model);

/// The gauge of that name in the deck. Throws DeckError at its pointer.
std::unique_ptr<Gauge> make_gauge(const std::string& name, const deck::Gauge& gauge, const Model& model);

/// Not a gauge of the deck, but what an observation of a deposit's profile reads above `at` (horizontal coordinates, m): the height gauge
/// of one body alone, or the ground and the volume of that body above it by area; the ground where that body is not.
std::unique_ptr<Gauge> make_deposit_gauge(const deck::Numbers& at, const Model& model, std::size_t body, deck::ProfileReading reading);

/// The box from min to max, wider by `margin` on all sides, m.
Region around(const deck::Numbers& min, const deck::Numbers& max, double margin);
/// Upper ends of the domain, m.
Point domain_max(const Model& model);
/// The axis that gravity is most nearly along (the last one without gravity), and +1 or −1: the direction along it that is up.
struct UpAxis {
  int axis;
  double sign;
};
UpAxis up_axis(const Model& model);
/// Place of a body among the model's. Throws DeckError at `pointer` when there is none of that name.
std::size_t body_index(const Model& model, const std::string& name, const std::string& pointer);

}  // namespace jaxmpm
