#include "services/stereo/core/sad5_thesis.h"

namespace thalweg::stereo {

Sad5Options AsTheThesisPrints(Sad5Options options) {
  options.prefilter.kind = Prefilter::kBilateralBlur;  // Eq. (3.17)
  options.prefilter.bilateral_sigma_distance = 10.0;
  options.prefilter.bilateral_sigma_range = 5.0;
  options.max_difference = 255;  // the largest there is
  options.left_right = 0;
  options.corners_connect = true;
  return options;
}

}  // namespace thalweg::stereo
