#pragma once

#include "services/stereo/core/matcher.h"

namespace thalweg::stereo {

/// Options of SAD5 as the source thesis prints it in Chapter 3; engine sad5-thesis. The other engines sad5-*
/// depart from it where that lowers their error rates.
///
/// Printed there, and set here whatever the given options say:
/// - both images are replaced by their bilateral blur, Eq. (3.17), with sigmas of 10 px and 5 gray values;
/// - differences are not truncated;
/// - left and right must agree to the pixel;
/// - regions are 8-connected.
/// Scores and uniqueness are Eq. (3.27) to (3.29), as in all of sad5-*.
///
/// Departures that remain:
/// - Scores have 16 bits. They hold any difference in windows of up to 9 px. In larger ones differences are
///   truncated, at Sad5::cut(): 180 gray values at 11 px, 49 at 21 px.
/// - Swapped images match nothing, which Matcher::Match sees to.
///
/// What we do not have from the thesis is that of sad5-*: the size of the window (7 px only where it shows
/// all engines side by side), the threshold of uniqueness, and which candidates are the second best; the
/// parabola; the size of a small region, and the step that ends it; what lies outside the image; how color
/// becomes gray; how far the blur reaches (here 1.5 sigma), and that it is rounded to whole gray values.
///
/// @param options  Those of sad5-*.
Sad5Options AsTheThesisPrints(Sad5Options options);

}  // namespace thalweg::stereo
