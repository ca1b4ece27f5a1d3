C     The diagonal apart, connected parts, facts of a body, numbers of
C     the host: 5 4 of the chain, 3 2 of the bar, 1 of the point.
      SUBROUTINE NUMBER(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, I, IPTR(3), ICOL(1), INUM(5), IC(2), IF(FTNIBD)
      DOUBLE PRECISION D(2), V(1), U(5), R(5), F(5), RF(FTNRBD)
      DATA IPTR / 1, 1, 2 /, ICOL / 1 /, INUM / 5, 4, 3, 2, 1 /
      DATA D / 1D2, 1D2 /, V / -1D2 /, F / 0D0, -2D1, 3 * 0D0 /
      CALL FTBSPL(IP, 2, 2, D, IPTR, ICOL, V, 5, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 8, 'storage 5')
      CALL FTBSPL(IP, 2, 2, D, IPTR, ICOL, V, FTLOWR, IERR)
      CALL OK(IERR, 'FTBSPL')
      CALL SOLVES(IP, 10D0, -0.3D0, 'a stiffer bar')
      CALL FTDISP(IP, 2, 2, U, IERR)
      CALL OK(IERR, 'FTDISP')
      CALL SAME(U(2), -0.4D0, 'a stiffer bar')
      D(1) = 5D1
      D(2) = 5D1
      V(1) = -5D1
      CALL FTBVSP(IP, 2, 2, D, 1, V, IERR)
      CALL OK(IERR, 'FTBVSP')
      CALL SOLVES(IP, 10D0, -0.3D0, 'the bar of the beginning')
      CALL FTBCMP(IP, 2, 2, IC, IERR)
      CALL OK(IERR, 'FTBCMP')
      CALL HOLDS(IC(1) .EQ. 1 .AND. IC(2) .EQ. 1, 'FTBCMP')
      CALL FTBINF(IP, 2, FTNIBD, IF, FTNRBD, RF, IERR)
      CALL OK(IERR, 'FTBINF')
      CALL HOLDS(IF(FTBUNK) .EQ. 2 .AND. IF(FTBPRT) .EQ. 1 .AND.
     &  IF(FTBORI) .EQ. FTOREX .AND. IF(FTBNSP) .EQ. 1 .AND.
     &  IF(FTBSFR) .EQ. 0 .AND. IF(FTBSHL) .EQ. 0, 'FTBINF')
      CALL SAME(RF(FTBENT), 3D0, 'entries of the bar')
      CALL HOLDS(RF(FTBERR) .GE. 0D0 .AND. RF(FTBERR) .LT. 1D-9,
     &  'error of the forces on the bar')
      DO 10 I = 1, 2
        CALL FTBNUM(IP, I, 2, INUM(2 * I - 1), IERR)
   10   CALL OK(IERR, 'FTBNUM')
      CALL FTBNUM(IP, 3, 1, INUM(5), IERR)
      CALL OK(IERR, 'FTBNUM')
      CALL FTDISP(IP, FTALL, 5, U, IERR)
      CALL OK(IERR, 'FTDISP')
      CALL SAME(U(5), -0.1D0, 'number 5')
      CALL SAME(U(2), -0.5D0, 'number 2')
      CALL SAME(U(1), 0.25D0, 'number 1')
      CALL FTREAC(IP, FTKINE, FTALL, 5, R, IERR)
      CALL OK(IERR, 'FTREAC')
      CALL SAME(R(4), -10D0, 'reaction on number 4')
      CALL SAME(R(3), 10D0, 'reaction on number 3')
      CALL FTDISP(IP, 0, 5, U, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 2, 'body 0 is none')
      CALL FTBLOD(IP, FTALL, 5, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL SOLVES(IP, 20D0, -0.5D0, 'a load in numbers of the host')
      F(2) = -10D0
      CALL FTBLOD(IP, FTALL, 5, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL SOLVES(IP, 10D0, -0.3D0, 'the load of the beginning')
      END

C     The host has two unknowns, of which the second is .5 + 3 times the
C     first, a spring 2. A load 4 on the second is 12 on the spring.
      SUBROUTINE TABLE
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IB, IERR, IWORD(2), IPTR(2), ICOL(1), INUM(2), IT(3)
      INTEGER ITERM(1), INFO(1)
      DOUBLE PRECISION DWORD(2), RINFO(1), V(1), COEF(1)
      DOUBLE PRECISION CONST(2), F(2), U(2)
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /
      DATA IPTR / 1, 2 /, ICOL / 1 /, INUM / 1, 0 /, IT / 1, 1, 2 /
      DATA ITERM / 1 /, V / 2D0 /, COEF / 3D0 /, CONST / 0D0, 5D-1 /
      DATA F / 0D0, 4D0 /
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL OK(IERR, 'FTNEW')
      CALL FTBADD(IP, 1, IB, IERR)
      CALL OK(IERR, 'FTBADD')
      CALL FTBSTF(IP, IB, 1, IPTR, ICOL, V, FTLOWR, IERR)
      CALL OK(IERR, 'FTBSTF')
      CALL FTDTAB(IP, 2, INUM, IT, ITERM, COEF, CONST, IERR)
      CALL OK(IERR, 'FTDTAB')
      CALL FTBLOD(IP, FTALL, 2, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL FTSOLV(IP, 0, INFO, 0, RINFO, IERR)
      CALL OK(IERR, 'FTSOLV')
      CALL FTDISP(IP, FTALL, 2, U, IERR)
      CALL OK(IERR, 'FTDISP')
      CALL SAME(U(1), 6D0, 'the spring')
      CALL SAME(U(2), 18.5D0, 'the unknown of the table')
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      END
