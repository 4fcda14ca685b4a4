"""The executor of a cluster, beside a cluster that does what it is told."""

import pickle
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Future

import pytest

from labcal.errors import DeviceError, InputError, WorkerError
from labcal.run import cluster_executor
from labcal.run.cluster_address import require_address
from labcal.run.cluster_executor import ClusterExecutor


class FakeCluster:
    """Workers by name, each with the reason why it cannot be used; what is sent may have to wait."""

    def __init__(self) -> None:
        self.there: dict[str, str | None] = {"one": None, "two": None}
        self.answers = True
        self.connections: list[FakeConnection] = []
        self.through = True
        self.killers: set[int] = set()

    def connect(self) -> "FakeConnection":
        if not self.answers:
            raise DeviceError("nobody answers")
        self.connections.append(FakeConnection(self))
        return self.connections[-1]


class FakeConnection:
    def __init__(self, cluster: FakeCluster) -> None:
        self.cluster, self.opened = cluster, True
        self.sent: list[tuple[Future[bytes], bytes, tuple[str, ...]]] = []

    def is_open(self) -> bool:
        return self.opened

    def workers(self) -> frozenset[str]:
        return frozenset(self.cluster.there)

    def refusals(self, workers: Sequence[str]) -> dict[str, str | None]:
        return {worker: self.cluster.there[worker] for worker in workers}

    def submit(self, case: bytes, workers: Sequence[str]) -> Future[bytes]:
        future: Future[bytes] = Future()
        self.sent.append((future, case, tuple(workers)))
        if self.cluster.through:
            threading.Thread(target=self.do, args=(future, case)).start()
        return future

    def do(self, future: Future[bytes], case: bytes) -> None:
        work = pickle.loads(case)  # noqa: S301 - made here
        if work.args[0] in self.cluster.killers:
            future.set_exception(WorkerError("at one"))
            return
        try:
            future.set_result(pickle.dumps(work()))
        except Exception as error:  # noqa: BLE001 -- as a worker does
            future.set_exception(error)

    def break_down(self) -> None:
        self.opened = False
        for future, _, _ in self.sent:
            future.cancel()

    def close(self) -> None:
        self.break_down()


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_executor, "LOOK_S", 0.01)
    monkeypatch.setattr(cluster_executor, "PATIENCE_S", 0.3)


@pytest.fixture
def cluster() -> FakeCluster:
    return FakeCluster()


@pytest.fixture
def executor(cluster: FakeCluster) -> Iterator[ClusterExecutor]:
    made = ClusterExecutor(cluster.connect, "tcp://fake:1")
    yield made
    made.shutdown(cancel_futures=True)


def square(number: int) -> int:
    if number < 0:
        raise InputError(f"{number} is negative")
    return number**2


def results(futures: list[Future[int]]) -> list[int]:
    return [future.result(timeout=10) for future in futures]


def wait_until(connection: FakeConnection, count: int) -> None:
    deadline = time.monotonic() + 10
    while len(connection.sent) < count:
        assert time.monotonic() < deadline
        time.sleep(0.005)


def test_cases_are_done_and_what_they_raise_is_raised(executor: ClusterExecutor) -> None:
    futures = [executor.submit(square, number) for number in (3, -1, 2)]
    assert results([futures[0], futures[2]]) == [9, 4]
    with pytest.raises(InputError, match="-1 is negative"):
        futures[1].result(timeout=10)


def test_what_was_sent_through_a_broken_connection_is_sent_again(
    executor: ClusterExecutor, cluster: FakeCluster
) -> None:
    cluster.through = False
    futures = [executor.submit(square, number) for number in range(5)]
    wait_until(cluster.connections[0], 5)
    cluster.through = True
    cluster.connections[0].break_down()
    assert results(futures) == [0, 1, 4, 9, 16]
    assert len(cluster.connections) == 2


def test_a_result_that_comes_after_its_case_was_sent_again_does_no_harm(
    executor: ClusterExecutor, cluster: FakeCluster
) -> None:
    cluster.through = False
    future = executor.submit(square, 3)
    wait_until(cluster.connections[0], 1)
    cluster.connections[0].opened = False  # it breaks, and Dask has not noticed yet
    wait_until_connected(cluster, 2)
    wait_until(cluster.connections[1], 1)
    cluster.connections[1].do(*cluster.connections[1].sent[0][:2])
    assert results([future]) == [9]


def wait_until_connected(cluster: FakeCluster, count: int) -> None:
    deadline = time.monotonic() + 10
    while len(cluster.connections) < count:
        assert time.monotonic() < deadline
        time.sleep(0.005)


def test_a_scheduler_that_stays_away_is_given_up(executor: ClusterExecutor, cluster: FakeCluster) -> None:
    cluster.through = cluster.answers = False
    future = executor.submit(square, 2)
    wait_until(cluster.connections[0], 1)
    cluster.connections[0].break_down()
    with pytest.raises(DeviceError, match=r"tcp://fake:1 is lost.* the same command resumes"):
        future.result(timeout=10)
    with pytest.raises(DeviceError, match="is lost"):
        executor.submit(square, 3).result(timeout=10)


def test_a_worker_that_is_unfit_gets_nothing_and_is_told_of_once(
    cluster: FakeCluster, caplog: pytest.LogCaptureFixture
) -> None:
    cluster.there["two"] = "it has labcal 0.0.9"
    executor = ClusterExecutor(cluster.connect, "tcp://fake:1")
    assert results([executor.submit(square, number) for number in range(20)]) == [n**2 for n in range(20)]
    time.sleep(0.1)
    executor.shutdown()
    assert {workers for _, _, workers in cluster.connections[0].sent} == {("one",)}
    assert [record.getMessage() for record in caplog.records] == [
        "The worker two of the cluster is left out: it has labcal 0.0.9."
    ]


def test_workers_that_come_later_are_used_and_what_the_lost_ones_had_is_sent_again(
    executor: ClusterExecutor, cluster: FakeCluster
) -> None:
    cluster.through = False
    future = executor.submit(square, 4)
    wait_until(cluster.connections[0], 1)
    cluster.through, cluster.there = True, {"three": None}
    assert results([future]) == [16]
    assert [workers for _, _, workers in cluster.connections[0].sent] == [("one", "two"), ("three",)]


def test_a_case_whose_workers_always_go_is_given_up_and_the_others_are_done(
    executor: ClusterExecutor, cluster: FakeCluster
) -> None:
    cluster.through = False
    futures = [executor.submit(square, number) for number in (2, 3)]
    connection = cluster.connections[0]
    wait_until(connection, 2)
    count = 2
    for _ in range(cluster_executor.LOSSES_WITH_OTHERS):
        cluster.there = {f"worker-{count}": None}
        wait_until(connection, count + 2)
        count = len(connection.sent)
    by_case = {pickle.loads(case).args[0]: (future, case) for future, case, _ in connection.sent[-2:]}  # noqa: S301
    connection.do(*by_case[3])
    assert results(futures[1:]) == [9]
    for _ in range(cluster_executor.LOSSES_ALONE + 1):
        cluster.there = {f"worker-{count}": None}
        count += 1
        deadline = time.monotonic() + 10
        while len(connection.sent) < count and not futures[0].done():
            assert time.monotonic() < deadline
            time.sleep(0.005)
    with pytest.raises(WorkerError, match="at worker-"):
        futures[0].result(timeout=10)


def test_a_cluster_without_a_worker_that_can_be_used_is_given_up_with_the_reasons(
    executor: ClusterExecutor, cluster: FakeCluster
) -> None:
    cluster.there, cluster.through = {"four": "it has numpy 1.0 and not 2.0"}, False
    with pytest.raises(DeviceError, match=r"left out \(four: it has numpy 1\.0 and not 2\.0\)"):
        executor.submit(square, 4).result(timeout=10)


def test_a_case_that_ends_workers_is_tried_again_alone_and_its_neighbours_are_done(
    executor: ClusterExecutor, cluster: FakeCluster
) -> None:
    cluster.killers = {2}
    futures = [executor.submit(square, number) for number in range(5)]
    assert results(futures[:2] + futures[3:]) == [0, 1, 9, 16]
    with pytest.raises(WorkerError, match="at one"):
        futures[2].result(timeout=10)
    cases = [pickle.loads(case) for _, case, _ in cluster.connections[0].sent]  # noqa: S301 - made here
    assert sorted(case.args[0] for case in cases) == [0, 1, 2, 2, 3, 4]


def test_a_case_that_was_in_ended_workers_by_chance_is_done_in_the_end(
    executor: ClusterExecutor, cluster: FakeCluster
) -> None:
    cluster.killers, cluster.through = {2}, False
    futures = [executor.submit(square, number) for number in (1, 2)]
    wait_until(cluster.connections[0], 2)
    cluster.connections[0].do(*cluster.connections[0].sent[1][:2])
    cluster.killers = set()
    assert len(cluster.connections[0].sent) == 2  # the suspect waits until nothing else is there
    cluster.through = True
    cluster.connections[0].do(*cluster.connections[0].sent[0][:2])
    assert results(futures) == [1, 4]


def test_shutting_down_cancels_what_is_left(cluster: FakeCluster) -> None:
    cluster.through = False
    executor = ClusterExecutor(cluster.connect, "tcp://fake:1")
    futures = [executor.submit(square, number) for number in range(3)]
    executor.shutdown(cancel_futures=True)
    assert all(future.done() for future in futures)
    assert not cluster.connections[0].opened
    with pytest.raises(RuntimeError, match="shut down"):
        executor.submit(square, 1)


def test_a_case_that_cannot_be_pickled_raises_that(executor: ClusterExecutor) -> None:
    with pytest.raises(TypeError, match="pickle"):
        executor.submit(square, threading.Lock()).result(timeout=10)  # type: ignore[arg-type]


@pytest.mark.parametrize("address", ["tcp://node-1:8786", "tcp://[::1]:8786", "tls://10.0.0.7:1"])
def test_addresses_are_taken_as_they_are(address: str) -> None:
    assert require_address(address) == address


@pytest.mark.parametrize(
    ("address", "hint"),
    [
        ("node-1:8786", "Did you mean 'tcp://node-1:8786'"),
        ("http://node-1:8786", "Did you mean 'tcp://node-1:8786'"),
        ("tcp:/node-1:8786", "Did you mean 'tcp://node-1:8786'"),
        ("tcp://node-1", "Did you mean 'tcp://node-1:8786'"),
        ("tcp://node-1:87860", "no address of a Dask scheduler"),
        ("", "no address of a Dask scheduler"),
        ("Local", "no address of a Dask scheduler"),
    ],
)
def test_what_is_no_address_is_refused_with_the_nearest_one(address: str, hint: str) -> None:
    with pytest.raises(InputError, match=hint):
        require_address(address)
