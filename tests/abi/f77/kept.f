C     The bar before a wall, its stiffness with the host alone: by hand
C     the force is 10, u = -.1 -.3. Then failures of the host.
      SUBROUTINE KEPT
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, IB, I, IWORD(2), IPTR(2), IDOF(1), INFO(FTNINF)
      INTEGER NPLUS, NTIMES, IFAIL, IBEXP
      DOUBLE PRECISION DWORD(2), R(2), DIAG(2), F(2), B(1), C(1), U(2)
      DOUBLE PRECISION RINFO(FTNRIN), STIFF
      COMMON /BARS/ STIFF, NPLUS, NTIMES, IFAIL, IBEXP
      INTEGER BAR
      EXTERNAL BAR
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /, IPTR / 1, 2 /
      DATA R / 1D0, 1D0 /, DIAG / 5D1, 5D1 /, F / 0D0, -1D1 /
      DATA B / -1D0 /, C / 0.1D0 /, IDOF / 1 /
      STIFF = 5D1
      NPLUS = 0
      NTIMES = 0
      IFAIL = 0
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL OK(IERR, 'FTNEW')
      CALL FTBADD(IP, 2, IB, IERR)
      CALL OK(IERR, 'FTBADD')
      IBEXP = IB
      CALL FTBOPR(IP, IB, 2, DIAG, BAR, 2, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 6, 'ICONC = 2')
      CALL FTBOPR(IP, IB, 2, DIAG, BAR, 0, IERR)
      CALL OK(IERR, 'FTBOPR')
      CALL FTBNUL(IP, IB, 1, 2, R, 2, FTEXCT, IERR)
      CALL OK(IERR, 'FTBNUL')
      CALL FTBLOD(IP, IB, 2, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL FTROWC(IP, FTKINE, 1, IPTR, IDOF, B, C, I, IERR)
      CALL OK(IERR, 'FTROWC')
      IFAIL = 7
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL HOLDS(IERR .EQ. FTECBK, 'a failure of the function')
      IFAIL = 0
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL OK(IERR, 'FTSOLV')
      CALL HOLDS(NPLUS .GT. 0 .AND. NTIMES .GT. 0, 'not multiplied')
      CALL HOLDS(RINFO(FTRWOR) .LE. 1D0, 'certificate of the bar')
      CALL FTDISP(IP, IB, 2, U, IERR)
      CALL OK(IERR, 'FTDISP')
      CALL SAME(U(1), -0.1D0, 'a bar kept by the host')
      CALL SAME(U(2), -0.3D0, 'a bar kept by the host')
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      END

      INTEGER FUNCTION BAR(IWHAT, IBODY, N, NRHS, X, LDX, Y, LDY)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IWHAT, IBODY, N, NRHS, LDX, LDY, J
      INTEGER NPLUS, NTIMES, IFAIL, IBEXP
      DOUBLE PRECISION X(LDX, NRHS), Y(LDY, NRHS), STIFF
      COMMON /BARS/ STIFF, NPLUS, NTIMES, IFAIL, IBEXP
      BAR = IFAIL
      IF (IBODY .NE. IBEXP .OR. N .NE. 2) BAR = 99
      DO 10 J = 1, NRHS
        IF (IWHAT .EQ. FTKPLS) THEN
          NPLUS = NPLUS + 1
          Y(1, J) = X(1, J) / STIFF
          Y(2, J) = 0D0
        ELSE
          NTIMES = NTIMES + 1
          Y(1, J) = STIFF * (X(1, J) - X(2, J))
          Y(2, J) = STIFF * (X(2, J) - X(1, J))
        END IF
   10 CONTINUE
      END
