#pragma once
// An inversion from its deck to inversion.json: optimiser, standard errors, a line for each iteration, files after each evaluation.
#include "inverse/inversion_files.hpp"

namespace jaxmpm {

class Inversion {
 public:
  /// `before`: evaluations of an earlier process, from InversionDirectory::read(). Throws DeckError where the optimiser does not fit the
  /// number of unknowns.
  Inversion(const deck::Deck& deck, const Unknowns& unknowns, Objective& objective, const InversionDirectory& directory,
            std::vector<RecordedEvaluation> before);

  /// Runs to the optimiser's end. On Stopped the files are as complete as after any evaluation: false is returned. Throws NumericsError
  /// when the first run is unstable, DeckError when the search leaves what the deck allows.
  bool run();
  const InversionState& state() const { return state_; }

 private:
  void take(const std::string& stopped);
  void note_failure();
  void tell_evaluation();
  void find_standard_errors();
  void compare_with_data();
  std::optional<Variables> errors_over_themselves(const Variables& best);
  void tell_result() const;
  void tell_bounds(const Variables& best) const;
  void tell_fit() const;

  const Unknowns& unknowns_;
  Objective& objective_;
  const InversionDirectory& directory_;
  deck::Optimizer optimizer_;
  RecordedLoss loss_;
  InversionState state_;
  std::size_t iterations_ = 0;
};

/// Standard errors of the numbers from a linearisation at the minimum: the square roots of the diagonal of s² (JᵀJ)⁻¹ with
/// s² = Σr²/(residuals − unknowns) (Seber & Wild 2003, section 2.1), times the slope of each number by its variable. Empty when the data do
/// not tell the unknowns apart. Bounds are not looked at.
std::optional<Variables> standard_errors(const Linearisation& about, const Variables& slopes);

}  // namespace jaxmpm
