#pragma once
// The describe() functions of the deck's structs (lib/deck/describe_*.cpp), and codecs of the values that take several forms.
#include "core/describe.hpp"
#include "deck/deck.hpp"

namespace jaxmpm::deck {

using described::Description;

described::EnumNames<Transfer> names_of(Transfer);
described::EnumNames<Basis> names_of(Basis);
described::EnumNames<GradientForm> names_of(GradientForm);
described::EnumNames<Precision> names_of(Precision);
described::EnumNames<ContactKind> names_of(ContactKind);

void describe(Description<Domain>& d);
void describe(Description<Time>& d);
void describe(Description<Rest>& d);
void describe(Description<Method>& d);
void describe(Description<Newtonian>& d);
void describe(Description<DruckerPrager>& d);
void describe(Description<LinearElastic>& d);
void describe(Description<NeoHookean>& d);
void describe(Description<Box>& d);
void describe(Description<Sphere>& d);
void describe(Description<Cylinder>& d);
void describe(Description<Polygon>& d);
void describe(Description<Mesh>& d);
void describe(Description<HeightMap>& d);
void describe(Description<AreaFile>& d);
void describe(Description<Layer>& d);
void describe(Description<Points>& d);
void describe(Description<Union>& d);
void describe(Description<Difference>& d);
void describe(Description<Mlp>& d);
void describe(Description<ParticleFile>& d);
void describe(Description<SurfacePoint>& d);
void describe(Description<Jitter>& d);
void describe(Description<Body>& d);
void describe(Description<Segment>& d);
void describe(Description<Wall>& d);
void describe(Description<Obstacle>& d);
void describe(Description<FrontGauge>& d);
void describe(Description<RegionMeanGauge>& d);
void describe(Description<HeightGauge>& d);
void describe(Description<PressureGauge>& d);
void describe(Description<ForceGauge>& d);
void describe(Description<EnergyGauge>& d);
void describe(Description<MomentumGauge>& d);
void describe(Description<ParticlesGauge>& d);
void describe(Description<Output>& d);
void describe(Description<Deck>& d);

}  // namespace jaxmpm::deck

namespace jaxmpm::described {

using LayerArea = std::variant<std::vector<deck::Numbers>, deck::AreaFile>;
JAXMPM_CODEC(deck::Material);
JAXMPM_CODEC(deck::Shape);
JAXMPM_CODEC(deck::Union);
JAXMPM_CODEC(deck::Difference);
JAXMPM_CODEC(LayerArea);
JAXMPM_CODEC(deck::Formula);
JAXMPM_CODEC(deck::Component);
JAXMPM_CODEC(deck::Velocity);
JAXMPM_CODEC(deck::InitialStress);
JAXMPM_CODEC(deck::Gauge);

}  // namespace jaxmpm::described
