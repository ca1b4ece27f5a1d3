C     FORTRAN 77: rank 0 lends the bodies of two problems, a point that
C     hangs on a spring of 2 and is pulled by 3.
      PROGRAM LENDS
      INCLUDE 'mpif.h'
      INTEGER IERR, IRANK
      CALL MPI_INIT(IERR)
      CALL MPI_COMM_RANK(MPI_COMM_WORLD, IRANK, IERR)
      IF (IRANK .EQ. 0) CALL HOST(MPI_COMM_WORLD)
      CALL FTMSRV(MPI_COMM_WORLD, IERR)
      CALL SURE(IERR, 'FTMSRV')
      CALL MPI_FINALIZE(IERR)
      END

      SUBROUTINE HOST(ICOMM)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER ICOMM, IWORD(2), IP, IERR, IB, K, INFO(FTNINF)
      DOUBLE PRECISION DWORD(2), A(1), F(1), U(1), RINFO(FTNRIN)
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /, A / 2D0 /, F / 3D0 /
      DO 10 K = 1, 2
        CALL FTNEW(IWORD, DWORD, IP, IERR)
        CALL SURE(IERR, 'FTNEW')
        CALL FTMPI(IP, ICOMM, IERR)
        CALL SURE(IERR, 'FTMPI')
        CALL FTBADD(IP, 1, IB, IERR)
        CALL SURE(IERR, 'FTBADD')
        CALL FTMPI(IP, ICOMM, IERR)
        IF (IERR .NE. FTESTA) STOP 2
        CALL FTBDNS(IP, IB, 1, A, 1, FTFULL, IERR)
        CALL SURE(IERR, 'FTBDNS')
        CALL FTBLOD(IP, IB, 1, F, IERR)
        CALL SURE(IERR, 'FTBLOD')
        CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
        CALL SURE(IERR, 'FTSOLV')
        CALL FTDISP(IP, IB, 1, U, IERR)
        CALL SURE(IERR, 'FTDISP')
        WRITE (*, '(A, F8.4)') ' u ', U(1)
        IF (INFO(FTIRNK) .LT. 1) STOP 3
        CALL FTFREE(IP, IERR)
        CALL SURE(IERR, 'FTFREE')
   10 CONTINUE
      END

      SUBROUTINE SURE(IERR, NAME)
      INTEGER IERR
      CHARACTER NAME*(*), TEXT*300
      IF (IERR .EQ. 0) RETURN
      CALL FTERR(IERR, TEXT)
      WRITE (*, *) NAME, ': ', TEXT
      STOP 1
      END
