#include "experiment/store.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "base/error.h"
#include "experiment/fake_run.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

// What `call` throws in a process of its own, so that it may be restricted; empty if nothing.
std::string MessageOfChild(const std::function<void()>& restrict_child,
                           const std::function<void()>& call) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    std::string message;
    try {
      restrict_child();
      call();
    } catch (const Error& e) {
      message = e.what();
    } catch (const std::exception& e) {
      message = std::string("not an Error: ") + e.what();
    }
    const ssize_t written = write(ends[1], message.data(), message.size());
    _exit(written == static_cast<ssize_t>(message.size()) ? 0 : 1);
  }
  close(ends[1]);
  std::string message(4096, 0);
  const ssize_t n = read(ends[0], message.data(), message.size());
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  message.resize(static_cast<std::size_t>(std::max<ssize_t>(0, n)));
  return message;
}

bool IsOneLine(const std::string& message) {
  return !message.empty() && message.find('\n') == std::string::npos;
}

TEST(StoreTest, AFullDiskKeepsWhatIsThereAndTheRunGoesOnLater) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder, kSmallExperiment, {"repetitions=100"});
  RunInto(experiment, folder / "whole");
  RunOptions some;
  some.limit = 4;
  RunInto(experiment, folder / "out", some);
  const auto size = fs::file_size(folder / "out/results.sqlite");
  for (const rlim_t room : {0, 8192}) {
    const std::string message = MessageOfChild(
        [&] {  // no file may grow beyond this: what a full disk is to the writer
          signal(SIGXFSZ, SIG_IGN);
          const rlimit limit = {size + room, size + room};
          setrlimit(RLIMIT_FSIZE, &limit);
        },
        [&] { RunInto(experiment, folder / "out"); });
    EXPECT_TRUE(IsOneLine(message)) << message;
    EXPECT_THAT(message, HasSubstr("results.sqlite"));
    EXPECT_GE(ResultStore::OpenForReading(folder / "out").FinishedIds().size(), 4u);
  }
  EXPECT_EQ(RunInto(experiment, folder / "out"), RunEnd::kComplete);
  EXPECT_EQ(Exported(folder / "out"), Exported(folder / "whole"));
}

TEST(StoreTest, AFullDiskLeavesNoHalfDatabase) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder, kSmallExperiment, {"repetitions=400"});
  const std::string message = MessageOfChild(
      [] {
        signal(SIGXFSZ, SIG_IGN);
        const rlimit limit = {30000, 30000};
        setrlimit(RLIMIT_FSIZE, &limit);
      },
      [&] { RunInto(experiment, folder / "out"); });
  EXPECT_TRUE(IsOneLine(message)) << message;
  EXPECT_FALSE(fs::exists(folder / "out/results.sqlite"));
}

TEST(StoreTest, AFolderThatMayNotBeWrittenIsRefusedInOneLine) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  RunOptions some;
  some.limit = 4;
  RunInto(experiment, folder / "out", some);
  fs::create_directory(folder / "shut");
  const auto as_nobody = [] {
    if (geteuid() == 0) ThrowUnless(seteuid(65534) == 0, "cannot become nobody");
  };
  fs::permissions(folder / "", fs::perms(0755));
  fs::permissions(folder / "shut", fs::perms(0555));
  fs::permissions(folder / "out", fs::perms(0555));
  const std::string before = ReadFile(folder / "out/results.sqlite");
  for (const char* where : {"shut", "shut/deeper", "out"}) {
    const std::string message =
        MessageOfChild(as_nobody, [&] { RunInto(experiment, folder / where); });
    EXPECT_TRUE(IsOneLine(message)) << where << ": " << message;
    EXPECT_THAT(message, HasSubstr(where));
  }
  fs::permissions(folder / "out", fs::perms(0755));
  EXPECT_EQ(ReadFile(folder / "out/results.sqlite"), before);
  EXPECT_TRUE(fs::is_empty(folder / "shut"));
}

TEST(StoreTest, ADatabaseThatIsCutShortOrNotItsOwnIsLeftAsItIs) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  RunInto(experiment, folder / "whole");
  const std::string whole = ReadFile(folder / "whole/results.sqlite");
  {
    Database other(folder / "other.sqlite", Database::Mode::kCreate);
    other.Execute("CREATE TABLE letters (to_whom TEXT)");
  }
  std::vector<std::string> databases = {"not a database", ReadFile(folder / "other.sqlite")};
  for (std::size_t n = 1; n < whole.size(); n += 4099) databases.push_back(whole.substr(0, n));
  for (const std::string& bytes : databases) {
    fs::create_directories(folder / "out");
    folder.Write("out/results.sqlite", bytes);
    for (const bool reading : {false, true}) {
      std::string message;
      try {
        if (reading) {
          Exported(folder / "out");
        } else {
          RunInto(experiment, folder / "out");
        }
      } catch (const Error& e) {
        message = e.what();
      }
      EXPECT_TRUE(IsOneLine(message)) << bytes.size() << " bytes: " << message;
      EXPECT_THAT(message, HasSubstr(folder / "out"));
    }
    EXPECT_TRUE(ReadFile(folder / "out/results.sqlite") == bytes) << bytes.size();
  }
}

TEST(StoreTest, RefusesAnotherExperimentAndLeavesItAlone) {
  const TemporaryFolder folder;
  RunInto(SmallExperiment(folder), folder / "out");
  const std::string before = ReadFile(folder / "out/results.sqlite");
  EXPECT_THROW(OpenStore(SmallExperiment(folder, kSmallExperiment, {"seed=8"}), folder / "out"),
               ForeignDirectory);
  Experiment changed = SmallExperiment(folder);
  folder.Write("scene.yaml", std::string(kSmallScene) + "max_finger_force: 3\n");
  EXPECT_THROW(OpenStore(changed, folder / "out"), ForeignDirectory);
  EXPECT_EQ(ReadFile(folder / "out/results.sqlite"), before);
}

TEST(StoreTest, RefusesAnotherBehaviourVersion) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  RunInto(experiment, folder / "out");
  Database(folder / "out/results.sqlite", Database::Mode::kCreate)
      .Execute("UPDATE meta SET value = '0' WHERE key = 'behaviour_version'");
  EXPECT_THROW(OpenStore(experiment, folder / "out"), ForeignDirectory);
}

TEST(StoreTest, RefusesFoldersThatAreNotItsOwn) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  fs::create_directory(folder / "full");
  folder.Write("full/letter.txt", "dear reader");
  EXPECT_THROW(OpenStore(experiment, folder / "full"), Error);
  EXPECT_THROW(OpenStore(experiment, folder.Write("file", "")), Error);
  EXPECT_THROW(ResultStore::OpenForReading(folder / "full"), Error);
  RunInto(experiment, folder / "cut");
  fs::resize_file(folder / "cut/results.sqlite", 3000);
  EXPECT_THROW(RunInto(experiment, folder / "cut"), Error);
  EXPECT_EQ(fs::file_size(folder / "cut/results.sqlite"), 3000u);
}

TEST(StoreTest, KeepsOneRunAtATime) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  const ResultStore first = OpenStore(experiment, folder / "out");
  const pid_t other = fork();
  if (other == 0) {
    try {
      OpenStore(experiment, folder / "out");
    } catch (const Error& e) {
      _exit(std::string(e.what()).find("another run") == std::string::npos ? 2 : 1);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(other, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

}  // namespace
}  // namespace springgrasp
