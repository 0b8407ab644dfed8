// The library: a folder of grasps as YAML, one file each.
#pragma once

#include <string>
#include <vector>

#include "demonstration/demonstration.h"
#include "grasp/grasp.h"

namespace springgrasp {

struct LibraryEntry {
  std::string path;
  Grasp grasp;
};

// Every *.yaml of a folder, by file name. Throws Error if the folder holds none, one cannot be read
// (file and line), or two have the same name.
std::vector<LibraryEntry> ReadLibrary(const std::string& folder);

// The shipped one, models/grasps.
std::string ShippedLibrary();

// The demonstration that an entry was learned from, if it is kept: the CSV beside the YAML.
std::string DemonstrationOfEntry(const std::string& path);

// What is wrong with a grasp, a sentence each; empty if nothing is: springs over-damped, every
// contact ray on the object, and on its own object the involved tips end within 1 mm of their
// contacts (profile human) without running away.
std::vector<std::string> CheckGrasp(const Grasp& grasp);

// How well a grasp of the library explains a demonstration of unknown type.
struct RecognisedGrasp {
  std::string name, type;
  double rmse = 0;  // m, of all observed tips in H, over the reach
};

// What every grasp's parameters generate for the demonstrated object in the demonstrated time,
// against the tips observed in H; the most similar first. Throws Error if the demonstration has no
// hand pose or too little to see.
std::vector<RecognisedGrasp> RecogniseGrasp(const Demonstration& demonstration,
                                            const std::vector<LibraryEntry>& library);

}  // namespace springgrasp
