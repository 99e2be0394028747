#include "core/manifest.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>

#include "core/error.h"
#include "core/files.h"

namespace vultus {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) fail();
  }
  void add(const void* bytes, std::size_t count) {
    if (EVP_DigestUpdate(context_.get(), bytes, count) != 1) fail();
  }
  std::string hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    if (EVP_DigestFinal_ex(context_.get(), digest.data(), &size) != 1) fail();
    std::string text;
    for (unsigned i = 0; i < size; ++i) {
      text += "0123456789abcdef"[digest[i] >> 4];
      text += "0123456789abcdef"[digest[i] & 15];
    }
    return text;
  }

 private:
  [[noreturn]] static void fail() { throw ToolError("OpenSSL offers no SHA-256; install libssl3"); }
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

// Of everything a manifest says, so that an edit by hand shows.
std::string digest(const json& content) {
  return sha256_of_bytes(json{content.at("kind"), content.at("facts"), content.at("artefacts")}.dump());
}

struct Closer {
  int descriptor;
  ~Closer() { ::close(descriptor); }
};

}  // namespace

std::string sha256_of_bytes(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

std::string sha256_of_file(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw InputError(file, std::strerror(errno));
  const Closer closer{descriptor};
  Sha256 hash;
  std::vector<char> buffer(std::size_t{1} << 20);
  for (;;) {
    const ssize_t got = ::read(descriptor, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(file, std::strerror(errno));
    if (got == 0) return hash.hex();
    hash.add(buffer.data(), static_cast<std::size_t>(got));
  }
}

std::string version() { return VULTUS_VERSION; }

json Provenance::json() const {
  return {{"version", version()}, {"command", command}, {"options", options}, {"inputs", inputs}};
}

Manifest Manifest::open(const fs::path& file, const std::string& kind) {
  Manifest manifest;
  manifest.file_ = file;
  manifest.folder_ = file.parent_path();
  manifest.kind_ = kind;
  std::error_code error;
  if (fs::status(file, error).type() == fs::file_type::not_found) return manifest;
  const nlohmann::json content = read_json(file);
  try {
    if (const std::string found = content.at("kind"); found != kind) {
      throw InputError(file, "describes a \"" + found + "\", not a \"" + kind + "\"");
    }
    if (content.at("sha256") != digest(content)) {
      throw InputError(file, "was changed by hand or damaged; run the command that made it again, with --force");
    }
    manifest.facts_ = content.at("facts");
    for (const auto& [name, entry] : content.at("artefacts").items()) {
      entry.at("sha256").get_ref<const std::string&>();
      if (!entry.at("made_by").is_object()) throw InputError(file, name, "has no provenance");
      manifest.artefacts_[name] = entry;
    }
  } catch (const nlohmann::json::exception& problem) {
    throw InputError(file, std::string("is not a Vultus manifest: ") + problem.what());
  }
  return manifest;
}

bool Manifest::is_current(const std::string& artefact, const Provenance& provenance) const {
  const auto found = artefacts_.find(artefact);
  if (found == artefacts_.end() || found->second.at("made_by") != provenance.json()) return false;
  const fs::path path = folder_ / artefact;
  std::error_code error;
  return fs::is_regular_file(path, error) && sha256_of_file(path) == found->second.at("sha256");
}

void Manifest::record(const std::string& artefact, const Provenance& provenance) {
  artefacts_[artefact] = {{"sha256", sha256_of_file(folder_ / artefact)}, {"made_by", provenance.json()}};
}

void Manifest::forget(const std::string& artefact) { artefacts_.erase(artefact); }

void Manifest::verify(const std::string& artefact) const {
  const std::string recorded = hash(artefact);
  const fs::path path = folder_ / artefact;
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(path, "is missing; run the command that made it again, with --force");
  if (sha256_of_file(path) != recorded) {
    throw InputError(path, "was changed since it was made (its hash differs from the one in " +
                               file_.filename().string() + "); run the command that made it again, with --force");
  }
}

std::vector<std::string> Manifest::damaged() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : artefacts_) {
    try {
      verify(name);
    } catch (const InputError&) {
      names.push_back(name);
    }
  }
  return names;
}

std::vector<std::string> Manifest::artefacts() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : artefacts_) names.push_back(name);
  return names;
}

std::string Manifest::hash(const std::string& artefact) const {
  const auto found = artefacts_.find(artefact);
  if (found == artefacts_.end()) {
    const std::string near = nearest_name(artefact, artefacts());
    throw InputError(file_, "does not list \"" + artefact + "\"" + (near.empty() ? "" : "; nearest: \"" + near + "\""));
  }
  return found->second.at("sha256");
}

void Manifest::save() const {
  nlohmann::json content = {{"kind", kind_}, {"version", version()}, {"facts", facts_}, {"artefacts", artefacts_}};
  content["sha256"] = digest(content);
  write_json(file_, content);
}

}  // namespace vultus
