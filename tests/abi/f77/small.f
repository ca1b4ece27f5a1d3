C     The problem of the FORTRAN 77 drivers, solved by hand: a chain of
C     two springs k = 100 on the ground (body 1), a free bar k = 50
C     (body 2), a point on a spring k = 4 (body 3). The bar is pushed by
C     10 across a gap of .1 against the chain, the point held at .25:
C        rows u12 - u21 <= .1 and u31 <= 1, held u31 = .25
C        u1 = -.1 -.2,  u2 = -.3 -.5,  u3 = .25
C        lambda = 10 0,  mu = -1,  open gaps 0 .75
      SUBROUTINE SMALL(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, IB, I, IWORD(2)
      INTEGER IPTR1(3), ICOL1(4), IPTR2(3), ICOL2(3)
      INTEGER IPTRB(3), IBODB(3), IDOFB(3), IPTRH(2), IDOFH(1)
      DOUBLE PRECISION DWORD(2), A1(4), A2(3), A3(1), R2(2), F2(2)
      DOUBLE PRECISION B(3), C(2), H(1), RHS(1)
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /
      DATA IPTR1 / 1, 3, 5 /, ICOL1 / 2, 1, 1, 2 /
      DATA A1 / -1D2, 2D2, -1D2, 1D2 /
      DATA IPTR2 / 1, 2, 4 /, ICOL2 / 1, 1, 2 /
      DATA A2 / 5D1, -5D1, 5D1 /, A3 / 4D0 /
      DATA R2 / 1D0, 1D0 /, F2 / 0D0, -1D1 /
      DATA IPTRB / 1, 3, 4 /, IBODB / 1, 2, 3 /, IDOFB / 2, 1, 1 /
      DATA B / 1D0, -1D0, 1D0 /, C / 0.1D0, 1D0 /
      DATA IPTRH / 1, 2 /, IDOFH / 5 /, H / 1D0 /, RHS / 0.25D0 /
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL OK(IERR, 'FTNEW')
      CALL FTBADD(IP, 2, IB, IERR)
      CALL OK(IERR, 'FTBADD')
      CALL HOLDS(IB .EQ. 1, 'the first body is not number 1')
      CALL FTBSTF(IP, IB, 2, IPTR1, ICOL1, A1, FTFULL, IERR)
      CALL OK(IERR, 'FTBSTF')
      CALL FTBREG(IP, IB, IERR)
      CALL OK(IERR, 'FTBREG')
      CALL FTBADD(IP, 2, IB, IERR)
      CALL OK(IERR, 'FTBADD')
      CALL FTBSTF(IP, IB, 2, IPTR2, ICOL2, A2, FTLOWR, IERR)
      CALL OK(IERR, 'FTBSTF')
      CALL FTBNUL(IP, IB, 1, 2, R2, 2, FTEXCT, IERR)
      CALL OK(IERR, 'FTBNUL')
      CALL FTBLOD(IP, IB, 2, F2, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL FTBADD(IP, 1, IB, IERR)
      CALL OK(IERR, 'FTBADD')
      CALL FTBDNS(IP, IB, 1, A3, 1, FTUPPR, IERR)
      CALL OK(IERR, 'FTBDNS')
      CALL FTROWS(IP, FTKINE, 2, IPTRB, IBODB, IDOFB, B, C, I, IERR)
      CALL OK(IERR, 'FTROWS')
      CALL HOLDS(I .EQ. 1, 'the first row is not number 1')
      CALL FTROWC(IP, FTKEQU, 1, IPTRH, IDOFH, H, RHS, I, IERR)
      CALL OK(IERR, 'FTROWC')
      CALL HOLDS(I .EQ. 1, 'the first equality row is not number 1')
      END

C     Solves and compares the first multiplier and u(2,1) with what they
C     are by hand.
      SUBROUTINE SOLVES(IP, RLAM1, U21, TEXT)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, INFO(FTNINF)
      DOUBLE PRECISION RLAM1, U21, RLAM(2), U(2), RINFO(FTNRIN)
      CHARACTER*(*) TEXT
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL OK(IERR, TEXT)
      CALL HOLDS(RINFO(FTRWOR) .LE. 1D0, 'certificate of '//TEXT)
      CALL FTMULT(IP, FTKINE, 2, RLAM, IERR)
      CALL OK(IERR, 'FTMULT')
      CALL SAME(RLAM(1), RLAM1, 'force of '//TEXT)
      CALL FTDISP(IP, 2, 2, U, IERR)
      CALL OK(IERR, 'FTDISP')
      CALL SAME(U(1), U21, 'displacement of '//TEXT)
      END

C     A call that has to succeed.
      SUBROUTINE OK(IERR, NAME)
      INTEGER IERR
      CHARACTER NAME*(*), TEXT*300
      CALL FTERR(IERR, TEXT)
      CALL HOLDS(IERR .EQ. 0, NAME//': '//TEXT)
      END

      SUBROUTINE SAME(A, B, TEXT)
      DOUBLE PRECISION A, B
      CHARACTER*(*) TEXT
      CALL HOLDS(ABS(A - B) .LE. 1D-9 * (1D0 + ABS(B)), TEXT)
      END
