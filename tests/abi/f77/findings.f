C     What has no solution, and what has many.
      SUBROUTINE FINDS(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, INFO(FTNINF), ID(FTNIDG), N, IROW(2), IB
      DOUBLE PRECISION F(2), RINFO(FTNRIN), RD(FTNRDG), V(2), W(2), C(1)
      DOUBLE PRECISION RM(6)
      CHARACTER TEXT*300, NAME*40
      CALL FTDIAG(IP, FTNIDG, ID, FTNRDG, RD, IERR)
      CALL OK(IERR, 'FTDIAG')
      CALL HOLDS(ID(FTGSTA) .EQ. 0 .AND. ID(FTGUND) .EQ. 0 .AND.
     &  ID(FTGBOD) .EQ. 0 .AND. ID(FTGNUB) .EQ. 0 .AND.
     &  ID(FTGNDB) .EQ. 0 .AND. ID(FTGDBD) .EQ. 0, 'FTDIAG, all well')
      CALL FTDROW(IP, FTKINE, 2, N, IROW, W, IERR)
      CALL OK(IERR, 'FTDROW')
C     u31 <= 1 has the direction of u31 = .25.
      CALL HOLDS(N .EQ. 1 .AND. IROW(1) .EQ. 2 .AND. ID(FTGRED) .EQ. 1,
     &  'FTDROW, a row repeats another one')
      CALL SAME(W(1), 1D0, 'multiple of the other row')
      CALL FTDDEP(IP, 2, N, IROW, IERR)
      CALL OK(IERR, 'FTDDEP')
      CALL HOLDS(N .EQ. 0, 'FTDDEP')
C     The bar is pulled away.
      F(1) = 0D0
      F(2) = 10D0
      CALL FTBLOD(IP, 2, 2, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL HOLDS(IERR .EQ. FTELNH .AND. INFO(FTISTA) .EQ. FTELNH,
     &  'a bar that is pulled away')
      CALL FTERR(IERR, TEXT)
      CALL HOLDS(INDEX(TEXT, 'body 2') .GT. 0, 'text: '//TEXT)
      CALL FTPERR(IP, TEXT, N, IERR)
      CALL OK(IERR, 'FTPERR')
      CALL HOLDS(INDEX(TEXT, 'body 2') .GT. 0 .AND. N .GT. 6, 'FTPERR')
      CALL FTDIAG(IP, FTNIDG, ID, FTNRDG, RD, IERR)
      CALL OK(IERR, 'FTDIAG')
      CALL HOLDS(ID(FTGSTA) .EQ. FTELNH .AND. ID(FTGBOD) .EQ. 2 .AND.
     &  RD(FTGMAR) .GT. 0.5D0 .AND. RD(FTGUNH) .GT. 0.1D0,
     &  'FTDIAG, the bar escapes')
      CALL FTDMOT(IP, 2, 2, V, IERR)
      CALL OK(IERR, 'FTDMOT')
      CALL SAME(V(1), 1D0, 'motion of the bar')
      CALL SAME(V(2), 1D0, 'motion of the bar')
C     Nothing pushes it: its place is open.
      F(2) = 0D0
      CALL FTBLOD(IP, 2, 2, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL OK(IERR, 'FTSOLV')
      CALL HOLDS(INFO(FTIUND) .EQ. 1, 'undetermined motions')
      CALL FTDUND(IP, 1, IB, RM, IERR)
      CALL OK(IERR, 'FTDUND')
      CALL HOLDS(IB .EQ. 2, 'the body that is free to move')
      CALL FTDUNM(IP, 1, 2, 2, V, IERR)
      CALL OK(IERR, 'FTDUNM')
      CALL SAME(ABS(V(1) + V(2)), 2D0, 'motion that is open')
C     Held at .25 the point cannot stay below 0.
      C(1) = 0D0
      CALL FTRRHS(IP, FTKINE, 2, 1, C, IERR)
      CALL OK(IERR, 'FTRRHS')
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL HOLDS(IERR .EQ. FTEGAP, 'rows that contradict each other')
      CALL FTDROW(IP, FTKINE, 2, N, IROW, W, IERR)
      CALL OK(IERR, 'FTDROW')
      CALL HOLDS(N .EQ. 1 .AND. IROW(1) .EQ. 2, 'FTDROW')
      CALL SAME(W(1), 1D0, 'weight of the row')
C     Without its contact rows the bar is untouched.
      CALL FTRCLR(IP, FTKINE, IERR)
      CALL OK(IERR, 'FTRCLR')
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL OK(IERR, 'FTSOLV')
      CALL FTDUNT(IP, 2, N, IROW, IERR)
      CALL OK(IERR, 'FTDUNT')
      CALL HOLDS(N .EQ. 2 .AND. IROW(1) .EQ. 1 .AND. IROW(2) .EQ. 2,
     &  'FTDUNT')
C     The facts of an error.
      CALL FTBLOD(IP, 7, 2, F, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 2, 'body 7 of 3')
      CALL FTEDET(FTNIDT, ID, FTNRDT, RD, NAME, IERR)
      CALL OK(IERR, 'FTEDET')
      CALL HOLDS(NAME .EQ. 'feti_body_load' .AND. ID(FTDSTA) .EQ.
     &  FTEARG - 2 .AND. ID(FTDARG) .EQ. 2, 'FTEDET')
      END

C     The bar alone before a wall, its motion found from coordinates.
      SUBROUTINE PLACES
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, IB, NR, NODE(2), IDIR(2), IWORD(2), IPTR(2)
      INTEGER IDOF(1), INFO(1), I
      DOUBLE PRECISION X(2), R(2), A(4), F(2), B(1), C(1), U(2)
      DOUBLE PRECISION DWORD(2)
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /, IPTR / 1, 2 /
      DATA NODE / 7, 9 /, IDIR / 1, 1 /, X / 0D0, 1D0 /, IDOF / 1 /
      DATA A / 5D1, -5D1, -5D1, 5D1 /, F / 0D0, -1D1 /
      DATA B / -1D0 /, C / 0.1D0 /
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL OK(IERR, 'FTNEW')
      CALL FTBADD(IP, 2, IB, IERR)
      CALL OK(IERR, 'FTBADD')
      CALL FTBDNS(IP, IB, 2, A, 2, FTFULL, IERR)
      CALL OK(IERR, 'FTBDNS')
      CALL FTBXYZ(IP, IB, 1, 2, NODE, IDIR, X, 1, IERR)
      CALL OK(IERR, 'FTBXYZ')
      CALL FTBLOD(IP, IB, 2, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL FTROWC(IP, FTKINE, 1, IPTR, IDOF, B, C, I, IERR)
      CALL OK(IERR, 'FTROWC')
      NR = 0
      CALL FTBNUG(IP, IB, 2, NR, R, 2, IERR)
      CALL OK(IERR, 'FTBNUG')
      CALL HOLDS(NR .EQ. 1, 'motions of a bar by coordinates')
      CALL FTSOLV(IP, 1, INFO, 0, X, IERR)
      CALL OK(IERR, 'FTSOLV')
      CALL FTDISP(IP, IB, 2, U, IERR)
      CALL OK(IERR, 'FTDISP')
      CALL SAME(U(1), -0.1D0, 'a bar before a wall')
      CALL SAME(U(2), -0.3D0, 'a bar before a wall')
C     Driven by 5 at the wall, which holds it: the force is 10.5.
      A(1) = 4.5D1
      CALL FTBVDN(IP, IB, 2, A, 2, IERR)
      CALL OK(IERR, 'FTBVDN')
      CALL FTSOLV(IP, 1, INFO, 0, X, IERR)
      CALL HOLDS(IERR .EQ. FTEIND, 'a driven bar')
      CALL FTBXYF(IP, IB, FTSOFT, IERR)
      CALL OK(IERR, 'FTBXYF')
      CALL FTSOLV(IP, 1, INFO, 0, X, IERR)
      CALL OK(IERR, 'FTSOLV')
      CALL FTMULT(IP, FTKINE, 1, R, IERR)
      CALL OK(IERR, 'FTMULT')
      CALL SAME(R(1), 10.5D0, 'a driven bar before a wall')
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      END
