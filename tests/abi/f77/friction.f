C     Friction by hand: a block on springs of stiffness 2, pressed by 4
C     against a wall with a coefficient of 0.5. Pushed by (3, 4) it
C     slips by (.9, 1.2) under (1.2, 1.6); a bound of 10 holds it.
      SUBROUTINE RUBS
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, IB, I, IWORD(2), IPTR(4), ICOL(3), IROW(2)
      INTEGER IDOFN(1), NROW(1), IT(3), IBODT(2), IDOFT(2), IST(1)
      INTEGER INFO(FTNINF), ICERT(FTNIVE), IDET(FTNIDT), ND, IDIM
      DOUBLE PRECISION DWORD(2), A(3), ONE(2), F(3), COEF(1), BND(1)
      DOUBLE PRECISION RINFO(FTNRIN), RCERT(FTNRVE), RDET(FTNRDT)
      DOUBLE PRECISION U(3), RLAM(1), RLT(2), S(2), R(3), SOLD(2), C(1)
      CHARACTER NAME*40
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /, IPTR / 1, 2, 3, 4 /
      DATA ICOL / 1, 2, 3 /, IROW / 1, 2 /, IDOFN / 3 /, NROW / 1 /
      DATA IT / 1, 2, 3 /, IBODT / 1, 1 /, IDOFT / 1, 2 /
      DATA A / 2D0, 2D0, 2D0 /, ONE / 1D0, 1D0 /, F / 3D0, 4D0, 4D0 /
      DATA COEF / 0.5D0 /, BND / 0D0 /, C / 0D0 /
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL OK(IERR, 'FTNEW')
      CALL FTBADD(IP, 3, IB, IERR)
      CALL OK(IERR, 'FTBADD')
      CALL FTBSTF(IP, IB, 3, IPTR, ICOL, A, FTLOWR, IERR)
      CALL OK(IERR, 'FTBSTF')
      CALL FTBLOD(IP, IB, 3, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL FTROWC(IP, FTKINE, 1, IROW, IDOFN, ONE, C, I, IERR)
      CALL OK(IERR, 'FTROWC')
      NROW(1) = 2
      CALL FTFADC(IP, 1, 2, NROW, IT, IDOFT, ONE, COEF, BND, I, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 4, 'a contact row not there')
      CALL FTEDET(FTNIDT, IDET, FTNRDT, RDET, NAME, IERR)
      CALL OK(IERR, 'FTEDET')
      CALL HOLDS(IDET(FTDNOD) .EQ. 1, 'FTDNOD')
      NROW(1) = 1
      BND(1) = -1D0
      CALL FTFADD(IP, 1, 2, NROW, IT, IBODT, IDOFT, ONE, COEF, BND, I,
     &  IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 10, 'a negative bound')
      BND(1) = 0D0
      CALL FTFADD(IP, 1, 2, NROW, IT, IBODT, IDOFT, ONE, COEF, BND, I,
     &  IERR)
      CALL OK(IERR, 'FTFADD')
      CALL HOLDS(I .EQ. 1, 'the first node is not number 1')
      CALL FTFCOM(IP, IERR)
      CALL HOLDS(IERR .EQ. FTESTA, 'FTFCOM without an answer')
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL OK(IERR, 'FTSOLV')
      CALL HOLDS(INFO(FTINOD) .EQ. 1 .AND. INFO(FTISTK) .EQ. 0 .AND.
     &  INFO(FTISLP) .EQ. 1 .AND. INFO(FTISTR) .GE. 0 .AND.
     &  INFO(FTINEW) .GE. 0, 'nodes of INFO')
      CALL HOLDS(MAX(RINFO(FTRCON), RINFO(FTRWRK), RINFO(FTRSTK)) .LE.
     &  1D-6, 'friction of RINFO')
      CALL FTMULT(IP, FTKTAN, 2, RLT, IERR)
      CALL OK(IERR, 'FTMULT')
      CALL SAME(RLT(1), 1.2D0, 'force 1')
      CALL SAME(RLT(2), 1.6D0, 'force 2')
      CALL FTFSLP(IP, 1, 2, S, IERR)
      CALL OK(IERR, 'FTFSLP')
      CALL SAME(S(1), 0.9D0, 'slip 1')
      CALL SAME(S(2), 1.2D0, 'slip 2')
      CALL FTFSTA(IP, 1, IST, IERR)
      CALL OK(IERR, 'FTFSTA')
      CALL HOLDS(IST(1) .EQ. FTFSLI, 'FTFSTA')
      CALL FTREAC(IP, FTKTAN, 1, 3, R, IERR)
      CALL OK(IERR, 'FTREAC')
      CALL SAME(R(1), -1.2D0, 'force on the block')
      CALL FTDISP(IP, 1, 3, U, IERR)
      CALL OK(IERR, 'FTDISP')
      CALL FTMULT(IP, FTKINE, 1, RLAM, IERR)
      CALL OK(IERR, 'FTMULT')
      CALL FTCHKF(IP, 3, U, 1, RLAM, 0, R, 1, 2, RLT, FTNIVE, ICERT,
     &  FTNRVE, RCERT, IERR)
      CALL OK(IERR, 'FTCHKF')
      CALL HOLDS(ICERT(FTVPAS) .EQ. 1 .AND. MAX(RCERT(FTVRCO),
     &  RCERT(FTVRWO), RCERT(FTVRST)) .LE. RCERT(FTRLIM), 'FTCHKF')
      RLT(1) = 2D0
      CALL FTCHKF(IP, 3, U, 1, RLAM, 0, R, 1, 2, RLT, FTNIVE, ICERT,
     &  FTNRVE, RCERT, IERR)
      CALL OK(IERR, 'FTCHKF')
      CALL HOLDS(ICERT(FTVPAS) .EQ. 0 .AND. ICERT(FTVCON) .EQ. 1,
     &  'FTCHKF of a force beyond its bound')
      CALL HOLDS(ICERT(FTVWRK) .LE. 1 .AND. ICERT(FTVSTK) .LE. 1,
     &  'nodes of FTCHKF')
      CALL FTFCOM(IP, IERR)
      CALL OK(IERR, 'FTFCOM')
      BND(1) = 1D1
      CALL FTFBND(IP, 1, 1, BND, IERR)
      CALL OK(IERR, 'FTFBND')
      COEF(1) = -1D0
      CALL FTFCOE(IP, 1, 1, COEF, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 4, 'a negative coefficient')
      COEF(1) = 0D0
      CALL FTFCOE(IP, 1, 1, COEF, IERR)
      CALL OK(IERR, 'FTFCOE')
      RLT(1) = 1.2D0
      CALL FTSTRT(IP, FTKTAN, 2, RLT, IERR)
      CALL OK(IERR, 'FTSTRT')
      CALL RUBBED(IP, 1.2D0, 1.6D0, 'held where it has slipped to')
      SOLD(1) = 0D0
      SOLD(2) = 0D0
      CALL FTFREF(IP, 1, 1, 2, SOLD, IERR)
      CALL OK(IERR, 'FTFREF')
      CALL RUBBED(IP, 3D0, 4D0, 'held where it was')
      C(1) = 0.5D0
      CALL FTFCMP(IP, 1, 1, C, IERR)
      CALL OK(IERR, 'FTFCMP')
      CALL RUBBED(IP, 1.5D0, 2D0, 'held by a spring')
      CALL FTFCNT(IP, ND, IDIM, IERR)
      CALL OK(IERR, 'FTFCNT')
      CALL HOLDS(ND .EQ. 1 .AND. IDIM .EQ. 2, 'FTFCNT')
      CALL FTFCLR(IP, IERR)
      CALL OK(IERR, 'FTFCLR')
      CALL FTFCNT(IP, ND, IDIM, IERR)
      CALL OK(IERR, 'FTFCNT')
      CALL HOLDS(ND .EQ. 0 .AND. IDIM .EQ. 0, 'FTFCNT without nodes')
      CALL FTFADC(IP, 1, 2, NROW, IT, IDOFT, ONE, COEF, BND, I, IERR)
      CALL OK(IERR, 'FTFADC')
      CALL RUBBED(IP, 3D0, 4D0, 'held by another node')
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      END

C     Solves; the node sticks under this force.
      SUBROUTINE RUBBED(IP, RLT1, RLT2, TEXT)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, INFO(1), IST(1)
      DOUBLE PRECISION RLT1, RLT2, RLT(2), RINFO(1)
      CHARACTER*(*) TEXT
      CALL FTSOLV(IP, 0, INFO, 0, RINFO, IERR)
      CALL OK(IERR, TEXT)
      CALL FTMULT(IP, FTKTAN, 2, RLT, IERR)
      CALL OK(IERR, TEXT)
      CALL SAME(RLT(1), RLT1, TEXT)
      CALL SAME(RLT(2), RLT2, TEXT)
      CALL FTFSTA(IP, 1, IST, IERR)
      CALL OK(IERR, TEXT)
      CALL HOLDS(IST(1) .EQ. FTFSTI, TEXT)
      END
