// The first frame: caps cut out by colour, and told apart by where they stand about the palm.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "base/fingers.h"
#include "vision/camera_model.h"
#include "vision/marker_colour.h"

namespace springgrasp {

// A connected region of cap colour.
struct MarkerBlob {
  Eigen::Vector2d centre;  // px, weighted by likelihood
  double area = 0;         // px
  cv::Rect box;
};

// Regions of likelihood above one half within `region` (whole picture by default), at least
// `min_area` px, largest first.
std::vector<MarkerBlob> SegmentMarkers(const cv::Mat& likelihood, double min_area,
                                       cv::Rect region = {});
// The same into memory that is kept from frame to frame. With `cap_area` (px, of one cap) regions
// of several caps that touch are parted into that many, at most five.
struct MarkerScratch {
  cv::Mat binary, labels;  // as large as the largest picture so far
  cv::Mat stats, centroids;
};
void SegmentMarkers(const cv::Mat& likelihood, double min_area, cv::Rect region,
                    MarkerScratch& scratch, std::vector<MarkerBlob>& blobs, double cap_area = 0);

// Radius of the largest disc within the blob in `box`, px: a cap's radius from wherever it is seen,
// as long as not more than half of its width is hidden.
double InscribedRadius(const cv::Mat& likelihood, const cv::Rect& box);

// A blob of the left and one of the right picture that may be the same cap.
struct MarkerPair {
  int left = 0, right = 0;  // indices into the blobs
  TriangulatedPoint point;
  double radius = 0;  // m, of the sphere of the same area at that depth (mean of the views)
};

// All pairings within `max_epipolar_px`, between 0.15 and 3 m, of a size ratio below 2.
std::vector<MarkerPair> PairMarkers(const StereoCameras& cameras,
                                    const std::vector<MarkerBlob>& left,
                                    const std::vector<MarkerBlob>& right, double max_epipolar_px);

// Sets of five pairs, each blob used once, that look like the caps of one hand, the likeliest first
// and at most `count`: radii alike (and like `cap_radius` if positive), no two more than 0.26 m or
// less than 8 mm apart.
std::vector<PerFinger<MarkerPair>> ChooseCaps(const std::vector<MarkerPair>& pairs,
                                              double cap_radius, int count = 1);

// Which hand shows its palm. A right hand shows thumb to pinkie counter-clockwise as one sees the
// picture; kEither decides by the thumb's distance from its neighbour alone.
enum class Handedness { kRight, kLeft, kEither };

// Labels five positions by polar angle about the palm: entry f is the index of finger f's cap.
// The order begins beside the widest gap, which is where the wrist is, and runs as the handedness
// says; with kEither the end that stands farther from its neighbour is the thumb.
PerFinger<int> LabelFingers(const PerFinger<Eigen::Vector2d>& caps, const Eigen::Vector2d& palm,
                            Handedness hand);

// True if the fingers seen stand about the palm as they did when labelled: `turn` is +1 if thumb to
// pinkie has growing atan2(v, u), else -1. Fewer than three are always in order.
bool InFingerOrder(const PerFinger<Eigen::Vector2d>& caps, const PerFinger<bool>& seen,
                   const Eigen::Vector2d& palm, int turn);
// Index to pinkie sorted by polar angle about the palm, seen from their middle and along `turn`:
// entry f is whose cap stands where f's should. The thumb, which may well cross, stays.
PerFinger<int> OrderAboutPalm(const PerFinger<Eigen::Vector2d>& caps, const Eigen::Vector2d& palm,
                              int turn);
// The turn of a labelling.
int FingerTurn(const PerFinger<Eigen::Vector2d>& caps, const Eigen::Vector2d& palm);

// Palm centre from the caps alone, where no skin is to be seen: centre of the circle that fits
// the arc of the caps best (algebraic fit), not farther off than twice their spread.
Eigen::Vector2d PalmFromCaps(const PerFinger<Eigen::Vector2d>& caps);

}  // namespace springgrasp
