#include "apps/film.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "core/error.h"
#include "core/files.h"

extern char** environ;  // NOLINT: the C library's name

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

// Runs a program with its output thrown away; its exit status, or 127 when it could not be started.
int run_quietly(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_RDWR, 0);
  }
  pid_t process = 0;
  const int problem = posix_spawnp(&process, arguments.front(), &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (problem != 0) return 127;
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 126;
}

// The list that ffmpeg's concat demuxer reads; quotes in names are written as it wants them.
std::string picture_list(const std::vector<fs::path>& pictures, double rate_hz) {
  std::string list = "ffconcat version 1.0\n";
  for (const fs::path& picture : pictures) {
    std::string name;
    for (const char c : fs::absolute(picture).string()) name += c == '\'' ? std::string("'\\''") : std::string(1, c);
    list += "file '" + name + "'\nduration " + std::to_string(1.0 / rate_hz) + "\n";
  }
  return list;
}

}  // namespace

void write_film(const fs::path& film, const std::vector<fs::path>& pictures, double rate_hz) {
  if (run_quietly({"ffmpeg", "-version"}) != 0)
    throw ToolError("a film needs ffmpeg; install it with: apt-get install ffmpeg");
  write_file_with(film, [&](const fs::path& temporary) {
    const fs::path list = temporary.string() + ".txt";
    write_file(list, picture_list(pictures, rate_hz));
    const int status = run_quietly({"ffmpeg",
                                    "-y",
                                    "-f",
                                    "concat",
                                    "-safe",
                                    "0",
                                    "-i",
                                    list.string(),
                                    "-r",
                                    std::to_string(rate_hz),
                                    "-vf",
                                    "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                    "-c:v",
                                    "libx264",
                                    "-crf",
                                    "18",
                                    "-pix_fmt",
                                    "yuv420p",
                                    "-movflags",
                                    "+faststart",
                                    temporary.string()});
    std::error_code ignored;
    fs::remove(list, ignored);
    if (status != 0)
      throw ToolError("ffmpeg cannot make " + film.string() + " (status " + std::to_string(status) + ")");
  });
}

}  // namespace vultus::apps
