C     FORTRAN 77: four bars stand on each other, bar K on rank K - 1, or
C     where there are fewer ranks on K - 1 modulo their number; each
C     weighs 1 and rests on the bar below by a row that names numbers.
      PROGRAM GIVES
      INCLUDE 'mpif.h'
      INTEGER IERR, IRANK, ISIZE
      CALL MPI_INIT(IERR)
      CALL MPI_COMM_RANK(MPI_COMM_WORLD, IRANK, IERR)
      CALL MPI_COMM_SIZE(MPI_COMM_WORLD, ISIZE, IERR)
      CALL HOST(MPI_COMM_WORLD, IRANK, ISIZE)
      CALL MPI_FINALIZE(IERR)
      END

      SUBROUTINE HOST(ICOMM, IRANK, ISIZE)
      INCLUDE 'mpif.h'
      INCLUDE 'feti_contact_f77.inc'
      INTEGER ICOMM, IRANK, ISIZE, NBAR, N
      PARAMETER (NBAR = 4, N = 10)
      INTEGER IWORD(2), IP, IERR, IB, I, K, M, INUM(N), IPTR(2), IDOF(2)
      INTEGER IROW, INFO(FTNINF)
      DOUBLE PRECISION DWORD(2), A(N,N), F(N), U(N), VAL(2), RHS(1)
      DOUBLE PRECISION RINFO(FTNRIN), R(NBAR), RMINE(NBAR), RALL(NBAR)
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /, VAL / -1D0, 1D0 /
      DATA RHS / 0D0 /
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL SURE(IERR, 'FTNEW')
      CALL FTMPI(IP, ICOMM, IERR)
      CALL SURE(IERR, 'FTMPI')
      M = 0
      DO 40 K = IRANK + 1, NBAR, ISIZE
        DO 20 I = 1, N
          INUM(I) = (K - 1) * N + I
          F(I) = -1D0 / N
          DO 10 IB = 1, N
            A(IB,I) = 0D0
   10     CONTINUE
          A(I,I) = 2D0
          IF (I .EQ. 1 .OR. I .EQ. N) A(I,I) = 1D0
          IF (I .GT. 1) A(I,I-1) = -1D0
   20   CONTINUE
        CALL FTBADD(IP, N, IB, IERR)
        CALL SURE(IERR, 'FTBADD')
        CALL FTBDNS(IP, IB, N, A, N, FTLOWR, IERR)
        CALL SURE(IERR, 'FTBDNS')
        CALL FTBLOD(IP, IB, N, F, IERR)
        CALL SURE(IERR, 'FTBLOD')
        CALL FTBNUM(IP, IB, N, INUM, IERR)
        CALL SURE(IERR, 'FTBNUM')
        IPTR(1) = 1
        IPTR(2) = 3
        IF (K .EQ. 1) IPTR(2) = 2
        IDOF(1) = INUM(1)
        IDOF(2) = INUM(1) - 1
        CALL FTROWC(IP, FTKINE, 1, IPTR, IDOF, VAL, RHS, IROW, IERR)
        CALL SURE(IERR, 'FTROWC')
        M = M + 1
   40 CONTINUE
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL SURE(IERR, 'FTSOLV')
      CALL FTMULT(IP, FTKINE, M, R, IERR)
      CALL SURE(IERR, 'FTMULT')
      DO 50 K = 1, NBAR
        RMINE(K) = 0D0
   50 CONTINUE
      DO 60 I = 1, M
        RMINE(IRANK + 1 + (I - 1) * ISIZE) = R(I)
        CALL FTDISP(IP, I, N, U, IERR)
        CALL SURE(IERR, 'FTDISP')
   60 CONTINUE
      CALL MPI_REDUCE(RMINE, RALL, NBAR, MPI_DOUBLE_PRECISION, MPI_SUM,
     &  0, ICOMM, IERR)
      IF (IRANK .EQ. 0) WRITE (*, '(A, 4F8.4)') ' forces ', RALL
      CALL FTFREE(IP, IERR)
      CALL SURE(IERR, 'FTFREE')
      END

      SUBROUTINE SURE(IERR, NAME)
      INTEGER IERR
      CHARACTER NAME*(*), TEXT*300
      IF (IERR .EQ. 0) RETURN
      CALL FTERR(IERR, TEXT)
      WRITE (*, *) NAME, ': ', TEXT
      STOP 1
      END
