// The fields of TrialCriteria by name: one list for reading, writing and hashing them.
#pragma once

#include "base/yaml_reader.h"
#include "experiment/phases.h"

namespace springgrasp {

struct CriterionField {
  const char* name;  // the YAML key
  double TrialCriteria::*member;
  Bounds bounds;
};

inline const CriterionField kCriterionFields[] = {
    {"settle", &TrialCriteria::settle, {0.01, 60}},
    {"grip", &TrialCriteria::grip, {0.1, 60}},
    {"lift", &TrialCriteria::lift, {0.1, 60}},
    {"hold", &TrialCriteria::hold, {0.1, 600}},
    {"force_duration", &TrialCriteria::force_duration, {0.01, 60}},
    {"shake_duration", &TrialCriteria::shake_duration, {0.1, 60}},
    {"after", &TrialCriteria::after, {0.1, 60}},
    {"window", &TrialCriteria::window, {0.01, 60}},
    {"place", &TrialCriteria::place, {0.2, 60}},
    {"release", &TrialCriteria::release, {0.1, 60}},
    {"retreat", &TrialCriteria::retreat, {0.2, 60}},
    {"rest", &TrialCriteria::rest, {0.05, 60}},
    {"lift_height", &TrialCriteria::lift_height, {0.01, 0.5}},
    {"force_per_mass", &TrialCriteria::force_per_mass, {0, 100}},
    {"shake_amplitude", &TrialCriteria::shake_amplitude, {0, 0.1}},
    {"shake_frequency", &TrialCriteria::shake_frequency, {0.1, 10}},
    {"min_shake_fraction", &TrialCriteria::min_shake_fraction, {0, 1}},
    {"contact_force", &TrialCriteria::contact_force, {0, 100}},
    {"max_other_load", &TrialCriteria::max_other_load, {0, 1}},
    {"min_opposition_deg", &TrialCriteria::min_opposition_deg, {0, 180}},
    {"max_table_force", &TrialCriteria::max_table_force, {0, 1000}},
    {"max_tip_table_force", &TrialCriteria::max_tip_table_force, {0, 1000}},
    {"max_early_motion", &TrialCriteria::max_early_motion, {0, 1}},
    {"max_early_tilt_deg", &TrialCriteria::max_early_tilt_deg, {0, 180}},
    {"max_slip", &TrialCriteria::max_slip, {0, 1}},
    {"max_slip_deg", &TrialCriteria::max_slip_deg, {0, 180}},
    {"max_place_distance", &TrialCriteria::max_place_distance, {0, 1}},
    {"max_place_tilt_deg", &TrialCriteria::max_place_tilt_deg, {0, 180}},
    {"max_place_speed", &TrialCriteria::max_place_speed, {0, 1}},
    {"palm_like_size", &TrialCriteria::palm_like_size, {0, 1}},
};
static_assert(sizeof(kCriterionFields) / sizeof(CriterionField) * sizeof(double) ==
                  sizeof(TrialCriteria),
              "every field of TrialCriteria must be listed");

}  // namespace springgrasp
