#pragma once

#include <string>

/// Where this build stands. Only places.cpp is compiled with these paths, so that the objects of all other
/// tests are the same in every checkout and a compiler cache can share them.
namespace thalweg::test {

std::string SourceFolder();  ///< Root of the repository.
std::string BinFolder();     ///< Where the programs are built.

}  // namespace thalweg::test
