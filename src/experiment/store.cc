#include "experiment/store.h"

#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "base/files.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDatabaseName = "results.sqlite";

constexpr const char* kSchema = R"(
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE trials (
  id TEXT PRIMARY KEY, position INTEGER NOT NULL UNIQUE, case_name TEXT NOT NULL,
  demonstration TEXT NOT NULL, baseline TEXT NOT NULL, repetition INTEGER NOT NULL,
  seed INTEGER NOT NULL, parameters TEXT NOT NULL);
CREATE TABLE results (
  id TEXT PRIMARY KEY REFERENCES trials, outcome TEXT NOT NULL, phase TEXT NOT NULL,
  message TEXT NOT NULL);
CREATE TABLE measurements (
  id TEXT NOT NULL REFERENCES results, name TEXT NOT NULL, value REAL NOT NULL,
  PRIMARY KEY (id, name)) WITHOUT ROWID;
CREATE TABLE wall_times (
  id TEXT NOT NULL REFERENCES results, stage TEXT NOT NULL, seconds REAL NOT NULL,
  PRIMARY KEY (id, stage)) WITHOUT ROWID;
)";

std::string DatabasePath(const std::string& directory) {
  return (fs::path(directory) / kDatabaseName).string();
}

bool HoldsResults(const std::string& directory) {
  std::error_code ignored;
  return fs::exists(DatabasePath(directory), ignored);
}

Outcome OutcomeNamed(const std::string& name) {
  for (std::size_t i = 0; i < kOutcomeNames.size(); ++i) {
    if (kOutcomeNames[i] == name) return static_cast<Outcome>(i);
  }
  Fail("the results hold the outcome '{}', which this program does not know", name);
}

// Meta, plan and files of a new results directory; the database appears complete or not at all.
void CreateDatabase(const std::string& directory, const RunDescription& run) {
  WriteFileAtomically((fs::path(directory) / "experiment.yaml").string(), run.experiment_yaml);
  WriteFileAtomically((fs::path(directory) / "provenance").string(), run.provenance);
  WriteThroughTemporary(DatabasePath(directory), [&](const std::string& temporary) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    Database database(temporary, Database::Mode::kCreate);
    Transaction transaction(database);
    database.Execute(kSchema);
    Statement meta = database.Prepare("INSERT INTO meta VALUES (?, ?)");
    meta.Bind(0, "schema_version").Bind(1, std::to_string(kSchemaVersion)).Run();
    meta.Bind(0, "behaviour_version").Bind(1, std::to_string(kBehaviourVersion)).Run();
    meta.Bind(0, "experiment").Bind(1, run.experiment_yaml).Run();
    meta.Bind(0, "source").Bind(1, run.source).Run();
    Statement insert = database.Prepare("INSERT INTO trials VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    std::int64_t position = 0;
    for (const PlanRow& row : run.plan) {
      insert.Bind(0, row.id).Bind(1, position++).Bind(2, row.case_name);
      insert.Bind(3, row.demonstration).Bind(4, row.baseline);
      insert.Bind(5, std::int64_t{row.repetition}).Bind(6, static_cast<std::int64_t>(row.seed));
      insert.Bind(7, row.parameters).Run();
    }
    transaction.Commit();
  });
}

std::string MetaOf(Database& database, const std::string& key) {
  Statement query = database.Prepare("SELECT value FROM meta WHERE key = ?");
  query.Bind(0, key);
  return query.Step() ? query.Text(0) : "";
}

void CheckPlan(Database& database, const std::string& directory, const RunDescription& run) {
  if (MetaOf(database, "experiment") != run.experiment_yaml) {
    throw ForeignDirectory(fmt::format(
        "{}: holds results of another experiment (see its experiment.yaml); choose another -o",
        directory));
  }
  Statement query = database.Prepare("SELECT id FROM trials ORDER BY position");
  std::vector<std::string> ids;
  while (query.Step()) ids.push_back(query.Text(0));
  bool same = ids.size() == run.plan.size();
  for (std::size_t i = 0; same && i < ids.size(); ++i) same = ids[i] == run.plan[i].id;
  if (!same) {
    throw ForeignDirectory(fmt::format(
        "{}: holds results of other trials (a scene or demonstration has changed since); choose "
        "another -o",
        directory));
  }
}

}  // namespace

// An advisory lock on the directory; the file itself stays, empty. A POSIX lock, because worker
// processes must not inherit it: it goes when this process goes.
struct ResultStore::Lock {
  explicit Lock(const std::string& directory) {
    fd = open((fs::path(directory) / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    ThrowUnless(fd >= 0, "{}: cannot be written", directory);
    struct flock whole_file = {};
    whole_file.l_type = F_WRLCK;
    whole_file.l_whence = SEEK_SET;
    if (fcntl(fd, F_SETLK, &whole_file) != 0) {
      close(fd);
      Fail("{}: another run is writing there", directory);
    }
  }
  ~Lock() { close(fd); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  int fd;
};

ResultStore::ResultStore(std::string directory, Database::Mode mode)
    : directory_(std::move(directory)),
      database_(std::make_unique<Database>(DatabasePath(directory_), mode)) {}

ResultStore::~ResultStore() = default;

void ResultStore::CheckVersions() {
  const std::string schema = MetaOf(*database_, "schema_version");
  const std::string behaviour = MetaOf(*database_, "behaviour_version");
  if (schema != std::to_string(kSchemaVersion)) {
    throw ForeignDirectory(fmt::format("{}: written with schema version {}, this program reads {}",
                                       directory_, schema, kSchemaVersion));
  }
  if (behaviour != std::to_string(kBehaviourVersion)) {
    throw ForeignDirectory(
        fmt::format("{}: written by behaviour version {}, this program is version {}", directory_,
                    behaviour, kBehaviourVersion));
  }
}

ResultStore ResultStore::OpenForRun(const std::string& directory, const RunDescription& run) {
  std::error_code error;
  const bool existed = fs::exists(directory, error);
  ThrowUnless(!existed || fs::is_directory(directory, error), "{}: is not a directory", directory);
  if (existed && !HoldsResults(directory)) {
    for (const auto& entry : fs::directory_iterator(directory, error)) {
      const std::string name = entry.path().filename();
      ThrowUnless(name[0] == '.' || name == "experiment.yaml" || name == "provenance",
                  "{}: is not empty and holds no results; choose another -o", directory);
    }
  }
  fs::create_directories(directory, error);
  ThrowUnless(fs::is_directory(directory), "{}: cannot be created ({})", directory,
              error.message());
  auto lock = std::make_shared<Lock>(directory);
  if (!HoldsResults(directory)) CreateDatabase(directory, run);
  ResultStore store(directory, Database::Mode::kCreate);
  store.lock_ = std::move(lock);
  store.CheckVersions();
  CheckPlan(*store.database_, directory, run);
  return store;
}

ResultStore ResultStore::OpenForReading(const std::string& directory) {
  ThrowUnless(HoldsResults(directory), "{}: no results there (no {})", directory, kDatabaseName);
  ResultStore store(directory, Database::Mode::kReadOnly);
  store.CheckVersions();
  return store;
}

std::string ResultStore::Meta(const std::string& key) { return MetaOf(*database_, key); }

std::set<std::string> ResultStore::FinishedIds() {
  std::set<std::string> ids;
  Statement query = database_->Prepare("SELECT id FROM results");
  while (query.Step()) ids.insert(query.Text(0));
  return ids;
}

void ResultStore::Add(const std::string& id, const TrialResult& result) {
  Transaction transaction(*database_);
  database_->Prepare("INSERT INTO results VALUES (?, ?, ?, ?)")
      .Bind(0, id)
      .Bind(1, std::string(OutcomeName(result.outcome)))
      .Bind(2, result.phase)
      .Bind(3, result.message)
      .Run();
  Statement measurement = database_->Prepare("INSERT INTO measurements VALUES (?, ?, ?)");
  for (const auto& [name, value] : result.values) {
    if (!std::isnan(value)) measurement.Bind(0, id).Bind(1, name).Bind(2, value).Run();
  }
  Statement wall_time = database_->Prepare("INSERT INTO wall_times VALUES (?, ?, ?)");
  for (const auto& [stage, seconds] : result.wall_s) {
    wall_time.Bind(0, id).Bind(1, stage).Bind(2, seconds).Run();
  }
  transaction.Commit();
}

std::vector<StoredTrial> ResultStore::Trials() {
  std::vector<StoredTrial> trials;
  Statement measurements =
      database_->Prepare("SELECT id, name, value FROM measurements ORDER BY id");
  Statement wall_times = database_->Prepare("SELECT id, stage, seconds FROM wall_times");
  std::map<std::string, std::map<std::string, double>> values, seconds;
  while (measurements.Step()) {
    values[measurements.Text(0)][measurements.Text(1)] = measurements.Real(2);
  }
  while (wall_times.Step()) seconds[wall_times.Text(0)][wall_times.Text(1)] = wall_times.Real(2);
  Statement query = database_->Prepare(
      "SELECT trials.id, case_name, demonstration, baseline, repetition, seed, parameters, "
      "outcome, phase, message FROM trials LEFT JOIN results USING (id) ORDER BY position");
  while (query.Step()) {
    StoredTrial trial;
    trial.plan = {query.Text(0),
                  query.Text(1),
                  query.Text(2),
                  query.Text(3),
                  static_cast<int>(query.Integer(4)),
                  static_cast<std::uint64_t>(query.Integer(5)),
                  query.Text(6)};
    if (!query.IsNull(7)) {
      TrialResult result;
      result.outcome = OutcomeNamed(query.Text(7));
      result.phase = query.Text(8);
      result.message = query.Text(9);
      result.values = values[trial.plan.id];
      result.wall_s = seconds[trial.plan.id];
      trial.result = std::move(result);
    }
    trials.push_back(std::move(trial));
  }
  return trials;
}

}  // namespace springgrasp
