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
      CALL FORMS(IP)
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

C     The bar by its profile, as COLSOL and FEAP store it, and by
C     triplets; new values are those of the beginning, 50 and -50.
      SUBROUTINE FORMS(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, MAXA(3), JP(2), LATE(3), IROW(4), ICOL(4)
      DOUBLE PRECISION A(3), B(3), D(2), D0(2), AU(1), AU0(1), V(4)
      DOUBLE PRECISION V0(4)
      DATA MAXA / 1, 2, 4 /, JP / 0, 1 /, LATE / 2, 3, 5 /
      DATA IROW / 2, 1, 2, 1 /, ICOL / 1, 1, 2, 1 /
      DATA A / 1D2, 1D2, -1D2 /, B / 5D1, 5D1, -5D1 /
      DATA D / 1D2, 1D2 /, D0 / 5D1, 5D1 /, AU / -1D2 /, AU0 / -5D1 /
      DATA V / -1D2, 3D1, 1D2, 7D1 /, V0 / -5D1, 3D1, 5D1, 2D1 /
      CALL FTBSKY(IP, 2, 2, LATE, A, FTSKUP, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 4, 'a profile from 2')
      CALL FTBSKY(IP, 2, 2, MAXA, A, 2, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 6, 'direction 2')
      CALL FTBSKY(IP, 2, 2, MAXA, A, FTSKUP, IERR)
      CALL OK(IERR, 'FTBSKY')
      CALL BAREND(IP, -0.4D0, 'a profile')
      CALL FTBVAL(IP, 2, 3, B, IERR)
      CALL OK(IERR, 'FTBVAL of a profile')
      CALL BAREND(IP, -0.5D0, 'new values of a profile')
      CALL FTBSKD(IP, 2, 1000, D, JP, AU, FTSKDN, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 3, '1000 unknowns')
      CALL FTBSKD(IP, 2, 2, D, JP, AU, 2, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 7, 'direction 2')
      CALL FTBSKD(IP, 2, 2, D, JP, AU, FTSKDN, IERR)
      CALL OK(IERR, 'FTBSKD')
      CALL BAREND(IP, -0.4D0, 'a profile with its diagonal apart')
      CALL FTBVSP(IP, 2, 2, D0, 1, AU0, IERR)
      CALL OK(IERR, 'FTBVSP of a profile')
      CALL BAREND(IP, -0.5D0, 'its new values')
      CALL FTBTRI(IP, 2, 2, 4, IROW, ICOL, V, FTUPPR, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 6, 'an entry below the diagonal')
      CALL FTBTRI(IP, 2, 2, 4, IROW, ICOL, V, FTLOWR, IERR)
      CALL OK(IERR, 'FTBTRI')
      CALL BAREND(IP, -0.4D0, 'triplets')
      CALL FTBVAL(IP, 2, 4, V0, IERR)
      CALL OK(IERR, 'FTBVAL of triplets')
      CALL BAREND(IP, -0.5D0, 'new values of triplets')
      END

C     The end of the bar, -0.4 with 100, -0.5 with 50.
      SUBROUTINE BAREND(IP, BYHAND, WHAT)
      INTEGER IP, IERR
      CHARACTER*(*) WHAT
      DOUBLE PRECISION BYHAND, U(2)
      CALL SOLVES(IP, 10D0, -0.3D0, WHAT)
      CALL FTDISP(IP, 2, 2, U, IERR)
      CALL OK(IERR, 'FTDISP')
      CALL SAME(U(2), BYHAND, WHAT)
      END
