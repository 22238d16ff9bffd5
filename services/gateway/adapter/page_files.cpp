#include "services/gateway/adapter/page_files.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace thalweg::gateway {
namespace {

const char* MediaType(const std::string& extension) {
  if (extension == ".html") return "text/html; charset=utf-8";
  if (extension == ".js") return "text/javascript; charset=utf-8";
  if (extension == ".css") return "text/css; charset=utf-8";
  if (extension == ".svg") return "image/svg+xml";
  return "application/octet-stream";
}

constexpr auto kNotBuilt =
    "<!doctype html><title>thalweg</title><body style=\"font:16px sans-serif;margin:3em\">"
    "<h1>The page was not built</h1><p>It needs Node.js and npm at build time: install the packages "
    "<code>nodejs</code> and <code>npm</code> and run <code>deploy/build</code> again.</p>"
    "<p>Foxglove and other clients can connect to this address all the same.</p>";

}  // namespace

PageFiles LoadPage(const std::filesystem::path& folder) {
  PageFiles files;
  std::error_code error;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, error)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    std::ostringstream content;
    content << in.rdbuf();
    std::string name = "/";
    name += entry.path().lexically_relative(folder).generic_string();
    files[name] = {MediaType(entry.path().extension()), content.str()};
  }
  const auto index = files.find("/index.html");
  files["/"] = index != files.end() ? index->second : PageFile{MediaType(".html"), kNotBuilt};
  return files;
}

bool HasPage(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "index.html");
}

std::string NoPageText(const std::string& url) {
  return "The page was not built, which needs the packages nodejs and npm, and deploy/build again. Foxglove "
         "can connect to ws" +
         url.substr(url.find(':')) + " all the same.";
}

std::filesystem::path PageFolder() {
  if (const char* const folder = std::getenv("THALWEG_PAGE")) return folder;
  const std::filesystem::path prefix =
      std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path();
  const std::filesystem::path installed = prefix / "share/thalweg/page";
  return std::filesystem::exists(installed) ? installed : prefix / "page";
}

}  // namespace thalweg::gateway
