"""Communicators of mpi4py: the functions of feti_communicator by its calls, as mpi/feti_mpi.c has them in C."""

from __future__ import annotations

import ctypes
import time

from mpi4py import MPI

from . import _raw
from ._library import FetiError, interruptible

CHUNK = 1 << 30  # bytes of a message at most: MPI counts in int
SPINS, SHORTEST, LONGEST = 2000, 20e-6, 100e-6  # tries before a rest, seconds of a rest


def barred():
    """MPI is not there, or this thread may not call it."""
    return not MPI.Is_initialized() or MPI.Is_finalized() or MPI.Query_thread() < MPI.THREAD_SERIALIZED and not MPI.Is_thread_main()


class Stream:
    """Messages on a duplicate of a communicator, of all problems that have this communicator: `table` names them by its own address."""

    def __init__(self, comm):
        self.comm, self.sent, self.error, self.closed = comm.Dup(), [], None, False
        self.comm.Set_errhandler(MPI.ERRORS_RETURN)
        machine = self.comm.Split_type(MPI.COMM_TYPE_SHARED)
        self.rank, local_size = self.comm.Get_rank(), machine.Get_size()
        machine.Free()
        self.table = _raw.feti_communicator(rank=self.rank, size=self.comm.Get_size(), local_size=local_size)
        self.table.struct_size = ctypes.sizeof(self.table)
        self.table.user = ctypes.addressof(self.table)
        self.table.send = _raw.feti_send_fn(lambda _, *message: self.catch(self.send, *message))
        self.table.flush = _raw.feti_flush_fn(lambda _: self.catch(self.flush))
        self.table.receive = _raw.feti_receive_fn(lambda _, *message: self.catch(self.receive, *message))

    def catch(self, work, *arguments):
        try:
            if self.closed or barred():
                raise RuntimeError("the communicator is freed, or this thread may not call MPI")
            work(*arguments)
            return 0
        except BaseException as error:  # the cause of the error of the call that runs
            self.error = self.error or error
            return 1

    def send(self, rank, size, data):
        try:
            for portion in portions(size, data):
                self.sent.append(self.comm.Isend([portion, MPI.BYTE], rank))
        except MPI.Exception:
            self.flush()  # after a failure the library frees what is on its way
            raise

    def flush(self):
        try:
            while self.sent:
                self.complete(self.sent.pop(0))
        finally:  # after a failure of one message the others are waited for, too
            if self.sent:
                self.flush()

    def receive(self, rank, size, data):
        for portion in portions(size, data):
            self.complete(self.comm.Irecv([portion, MPI.BYTE], rank))

    def complete(self, request):
        """Waits; the others sleep between their looks, rank 0 only yields: they wait for it."""
        tries = 0
        while not request.Test():
            tries += 1
            if tries > SPINS:
                time.sleep(min(SHORTEST + (tries - SPINS) * 1e-6, LONGEST) if self.rank else 0)

    def run(self, work, cancel):
        """`work()`, on this thread if it may be the only one for MPI; otherwise Ctrl-C is a `cancel()`, and is raised when all ranks have ended."""
        try:
            return interruptible(work, cancel) if MPI.Query_thread() >= MPI.THREAD_SERIALIZED else work()
        except FetiError as failed:
            raise failed from self.error
        finally:
            self.error = None


def portions(size, data):
    """The bytes at this address in messages that MPI can count."""
    return ((ctypes.c_char * min(CHUNK, size - k)).from_address(data + k) for k in range(0, size, CHUNK))


def forget(comm, keyval, stream):
    """The host frees its communicator."""
    stream.closed = True
    if not MPI.Is_finalized():
        stream.comm.Free()


KEY = MPI.Comm.Create_keyval(delete_fn=forget)


def stream_of(comm) -> Stream:
    """The stream of a communicator, its attribute; the first call makes it and is collective."""
    if barred() or comm == MPI.COMM_NULL or comm.Is_inter():
        raise FetiError(_raw.FETI_COMMUNICATION, "communicator: not one of a single group, or this thread may not call MPI")
    stream = comm.Get_attr(KEY)
    if stream is None:
        stream = Stream(comm)
        comm.Set_attr(KEY, stream)
    return stream

