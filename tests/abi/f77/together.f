C     600 bars, each pushed by 10 against a wall of its own at .1, kept
C     by a host whose function runs on several threads at a time and
C     takes its time. By hand: u = -.1 -.3 of each.
      PROGRAM TOGETH
      INCLUDE 'feti_contact_f77.inc'
      INTEGER NBARS
      PARAMETER (NBARS = 600)
      INTEGER IP, IERR, IB, I, K, IWORD(2), IPTR(2), IDOF(1)
      INTEGER INFO(FTNINF)
      DOUBLE PRECISION DWORD(2), R(2), DIAG(2), F(2), B(1), C(1), U(2)
      DOUBLE PRECISION RINFO(FTNRIN)
      INTEGER BAR
      EXTERNAL BAR
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /, IPTR / 1, 2 /
      DATA R / 1D0, 1D0 /, DIAG / 5D1, 5D1 /, F / 0D0, -1D1 /
      DATA IDOF / 1 /, B / -1D0 /, C / 0.1D0 /
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL OK(IERR, 'FTNEW')
      CALL FTSETI(IP, 'threads', 4, IERR)
      CALL OK(IERR, 'FTSETI')
      DO 10 K = 1, NBARS
        CALL FTBADD(IP, 2, IB, IERR)
        CALL OK(IERR, 'FTBADD')
        CALL FTBOPR(IP, IB, 2, DIAG, BAR, 1, IERR)
        CALL OK(IERR, 'FTBOPR')
        CALL FTBNUL(IP, IB, 1, 2, R, 2, FTEXCT, IERR)
        CALL OK(IERR, 'FTBNUL')
        CALL FTBLOD(IP, IB, 2, F, IERR)
        CALL OK(IERR, 'FTBLOD')
        CALL FTROWS(IP, FTKINE, 1, IPTR, IB, IDOF, B, C, I, IERR)
        CALL OK(IERR, 'FTROWS')
   10 CONTINUE
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL OK(IERR, 'FTSOLV')
      DO 20 K = 1, NBARS
        CALL FTDISP(IP, K, 2, U, IERR)
        CALL OK(IERR, 'FTDISP')
        CALL SAME(U(1), -0.1D0, 'a bar among others')
        CALL SAME(U(2), -0.3D0, 'a bar among others')
   20 CONTINUE
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      END

      INTEGER FUNCTION BAR(IWHAT, IBODY, N, NRHS, X, LDX, Y, LDY)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IWHAT, IBODY, N, NRHS, LDX, LDY, I, J
      DOUBLE PRECISION X(LDX, NRHS), Y(LDY, NRHS), WORK
      BAR = 0
      IF (IBODY .LT. 1 .OR. N .NE. 2) BAR = 99
      WORK = 1D0
      DO 10 I = 1, 20000
        WORK = SQRT(WORK + 1D0)
   10 CONTINUE
      IF (WORK .GT. 2D0) BAR = 98
      DO 20 J = 1, NRHS
        IF (IWHAT .EQ. FTKPLS) THEN
          Y(1, J) = X(1, J) / 5D1
          Y(2, J) = 0D0
        ELSE
          Y(1, J) = 5D1 * (X(1, J) - X(2, J))
          Y(2, J) = 5D1 * (X(2, J) - X(1, J))
        END IF
   20 CONTINUE
      END
