#include "estimation/stages.h"

#include "estimation/features.h"

namespace standin {

Stage stage_of(Term term) {
  switch (term) {
    case Term::kFrame:
      return Stage::kShared;
    case Term::kPlainPixels:
    case Term::kTexturedPixels:
    case Term::kMaskedPixels:
    case Term::kImpostorPixels:
      return Stage::kFill;
    default:
      return Stage::kGeometry;
  }
}

}  // namespace standin
