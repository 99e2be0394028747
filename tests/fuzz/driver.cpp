// Runs a fuzz target where the compiler has no libFuzzer: changes whole files at random, from a fixed seed on, and
// hands them to the target.
//
//   fuzz_c3d [--runs N] [--seed S] [--keep FILE] [FILE…]
//
// FILEs are further starting points; --keep writes each input before it runs, so that the one that stopped the process
// is there. "fuzz_c3d --runs 0 FILE" runs just the files.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "core/random.h"
#include "tests/fuzz/reader.h"

namespace {

using vultus::Random;

std::size_t place(Random& random, std::size_t size) { return size == 0 ? 0 : random.next() % size; }

/// Values at which counts, offsets and texts turn.
std::string edge(Random& random) {
  static const std::string edges[] = {std::string(1, '\0'),
                                      "\xff",
                                      "\x7f",
                                      "\x80",
                                      std::string("\xff\xff", 2),
                                      std::string("\0\0", 2),
                                      std::string("\0\x80", 2),
                                      std::string("\0\0\x80\x7f", 4),
                                      std::string("\0\0\0\0", 4),
                                      "99999999999",
                                      "-1",
                                      "1e39",
                                      "nan",
                                      "\t\t\t\t",
                                      "\n",
                                      ",,,,,,",
                                      "\"",
                                      "0"};
  return edges[random.below(static_cast<int>(std::size(edges)))];
}

void change(std::string& bytes, const std::vector<std::string>& seeds, Random& random) {
  // Most of what a file says stands at its start.
  const std::size_t reach = random.below(3) == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 2048);
  const std::size_t at = place(random, reach), length = 1 + place(random, random.below(4) == 0 ? 600 : 8);
  switch (random.below(7)) {
    case 0:
      if (!bytes.empty()) bytes[at] = static_cast<char>(random.below(256));
      break;
    case 1:
      if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
      break;
    case 2: {
      const std::string value = edge(random);
      bytes.replace(at, std::min(value.size(), bytes.size() - at), value);
      break;
    }
    case 3:
      bytes.erase(at, length);
      break;
    case 4:
      bytes.insert(at, bytes.substr(place(random, bytes.size()), length));
      break;
    case 5: {
      const std::string& other = seeds[place(random, seeds.size())];
      const std::size_t from = place(random, other.size());
      bytes.replace(at, std::min(length, bytes.size() - at), other.substr(from, length));
      break;
    }
    default:
      if (random.below(8) == 0) bytes.resize(place(random, bytes.size() + 1));
  }
}

void run(const std::string& bytes, const std::string& keep) {
  if (!keep.empty()) std::ofstream(keep, std::ios::binary) << bytes;
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

}  // namespace

int main(int argc, char** argv) {
  long runs = 10000;
  std::uint64_t seed = 1;
  std::string keep;
  std::vector<std::string> seeds = vultus::fuzz::seeds();
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool option = (word == "--runs" || word == "--seed" || word == "--keep") && i + 1 < argc;
    if (word == "--runs" && option) {
      runs = std::atol(argv[++i]);
    } else if (word == "--seed" && option) {
      seed = static_cast<std::uint64_t>(std::atol(argv[++i]));
    } else if (word == "--keep" && option) {
      keep = argv[++i];
    } else {
      std::ifstream stream(word, std::ios::binary);
      if (!stream) {
        std::fprintf(stderr, "%s cannot be read\n", word.c_str());
        return 1;
      }
      seeds.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    }
  }
  for (const std::string& whole : seeds) run(whole, keep);
  for (long i = 0; i < runs; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    std::string bytes = seeds[place(random, seeds.size())];
    for (int changes = 1 + random.below(8); changes > 0; --changes) change(bytes, seeds, random);
    run(bytes, keep);
  }
  std::printf("%ld inputs from %zu files\n", runs, seeds.size());
  return 0;
}
