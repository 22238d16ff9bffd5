#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace thalweg::gateway {

/// A file that the gateway serves.
struct PageFile {
  std::string media_type;
  std::string content;
};

/// Files by the path under which they are served, e.g. "/page.js"; "/" is index.html.
using PageFiles = std::map<std::string, PageFile, std::less<>>;

/// Reads all files of the folder into memory once, so that no request ever leads to the file system. If the
/// folder does not exist because the page was not built, returns a page that says how to build it.
PageFiles LoadPage(const std::filesystem::path& folder);

/// The page's folder: THALWEG_PAGE if set; else share/thalweg/page beside the bin folder of an installed
/// program; else page/ beside the bin folder of the build.
std::filesystem::path PageFolder();

/// Whether the page was built.
bool HasPage(const std::filesystem::path& folder = PageFolder());

/// What there is instead where it was not, for people.
std::string NoPageText(const std::string& url);

}  // namespace thalweg::gateway
