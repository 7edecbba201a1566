//===- NewFile.cpp --------------------------------------------------------===//
#include "NewFile.h"

#include "Clock.h"
#include "Layout.h"
#include "Ros.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tpc {

std::string errorText(int Error) {
  char Buffer[128];
  return strerror_r(Error, Buffer, sizeof(Buffer));
}

/// Empty without a home: then a folder of this user's own in /tmp is used.
static std::string folderOf(const Config &C) {
  if (!C.Folder.empty())
    return C.Folder;
  if (const char *Home = std::getenv("ROS_HOME"); Home && *Home)
    return std::string(Home) + "/tpc";
  if (const char *Home = std::getenv("HOME"); Home && *Home)
    return std::string(Home) + "/.ros/tpc";
  return "";
}

/// In /tmp anybody can make a folder or a link of any name before this process.
/// Returns false and sets \p Why if the folder is not this user's alone.
static bool makePrivateFolder(const std::string &Folder, std::string &Why) {
  struct stat Status;
  if (mkdir(Folder.c_str(), 0700) && errno != EEXIST)
    Why = Folder + ": " + errorText(errno);
  else if (lstat(Folder.c_str(), &Status))
    Why = Folder + ": " + errorText(errno);
  else if (!S_ISDIR(Status.st_mode) || Status.st_uid != geteuid() ||
           (Status.st_mode & 077))
    Why = Folder + ": not a folder of this user alone; set TPC_FOLDER or HOME";
  else
    return true;
  return false;
}

static bool makeFolder(const std::string &Folder) {
  for (size_t End = 1; End != std::string::npos;) {
    End = Folder.find('/', End + 1);
    if (mkdir(Folder.substr(0, End).c_str(), 0700) && errno != EEXIST &&
        errno != EISDIR)
      return false;
  }
  return true;
}

std::string programPath() {
  char Buffer[sizeof(layout::Header::Program)];
  ssize_t Length = readlink("/proc/self/exe", Buffer, sizeof(Buffer) - 1);
  return std::string(Buffer, std::max<ssize_t>(Length, 0));
}

/// The first part of the file name: the node, or the program if there is no
/// node.
static std::string nameOfProcess() {
  std::string Name = rosNodeName();
  if (Name.empty()) {
    Name = programPath();
    Name = Name.substr(Name.rfind('/') + 1);
  }
  while (!Name.empty() && Name.front() == '/')
    Name.erase(0, 1);
  for (char &C : Name)
    if (!std::isalnum(static_cast<unsigned char>(C)) && C != '_' && C != '-')
      C = '_';
  return Name.empty() ? "process" : Name.substr(0, 100);
}

static std::string fourDigits(uint32_t Number) {
  std::string Text = std::to_string(Number);
  return std::string(Text.size() < 4 ? 4 - Text.size() : 0, '0') + Text;
}

std::optional<NewFile> NewFile::create(const Config &C, SegmentName *Of,
                                       std::string &Why) {
  std::string Folder = folderOf(C);
  if (Folder.empty()) {
    Folder = "/tmp/tpc-" + std::to_string(geteuid());
    if (!makePrivateFolder(Folder, Why))
      return std::nullopt;
  } else if (!makeFolder(Folder)) {
    Why = Folder + ": " + errorText(errno);
    return std::nullopt;
  }
  std::string Stem =
      Folder + "/" + nameOfProcess() + "-" + std::to_string(getpid()) + "-" +
      std::to_string(Of ? Of->Began : Clock::real() / 1'000'000'000);
  for (int Try = 1;; ++Try) {
    const uint32_t Segment = Of ? Of->Next++ : 0;
    std::string Path = Stem +
                       (Of        ? "-" + fourDigits(Segment)
                        : Try > 1 ? "-" + std::to_string(Try)
                                  : "") +
                       ".tpc";
    // Processes in two containers can have the same number and so the same
    // path. The process that creates the temporary file first gets it.
    std::string New = Path + ".new";
    int Descriptor =
        open(New.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    bool IsTaken = Descriptor < 0 && errno == EEXIST;
    if (Descriptor >= 0 && !access(Path.c_str(), F_OK)) {
      IsTaken = true;
      close(Descriptor);
      unlink(New.c_str());
    }
    if (IsTaken && Try < 1000)
      continue;
    if (Descriptor < 0 || IsTaken) {
      Why = Path + ": " + errorText(IsTaken ? EEXIST : errno);
      return std::nullopt;
    }
    return NewFile{std::move(Path), Descriptor, Segment};
  }
}

bool NewFile::publish(std::string &Why) const {
  if (!rename((Path + ".new").c_str(), Path.c_str()))
    return true;
  Why = errorText(errno);
  return false;
}

void NewFile::discard() const {
  unlink((Path + ".new").c_str());
  close(Descriptor);
}

} // namespace tpc
