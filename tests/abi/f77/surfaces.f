C     Surfaces by hand: two strips of three nodes at x = 0, 1, 2, each
C     unknown on a spring of stiffness 4 to the ground. The lower strip
C     (body 1) is the master, the upper one the slave with areas .5, 1,
C     .5; a node pushed down by F across a gap g carries (F - 4 g) / 2.
      SUBROUTINE STRIPS
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, IB, I, K, IWORD(2), IPTR(7), ICOL(6)
      INTEGER IS(4), IPAIR, IFIRST, LINES(4), LOWER(4), IDOF(9), NONE(1)
      INTEGER INFO(1), IPFACT(FTNIPF), IDIAG(FTNIDG), IDET(FTNIDT)
      INTEGER ICERT(FTNIVE), IDIM, N, NF, ND
      DOUBLE PRECISION DWORD(2), A(6), X(6), WIDE(9), F(6), GROUND(4)
      DOUBLE PRECISION OFFSET(3), ONE(1), P(3), V(6), RPFACT(FTNRPF)
      DOUBLE PRECISION RINFO(1), RDET(FTNRDT), RDIAG(FTNRDG), U(12)
      DOUBLE PRECISION RLAM(6), RCERT(FTNRVE), RLT(3)
      CHARACTER NAME*40
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /, A / 6 * 4D0 /
      DATA IPTR / 1, 2, 3, 4, 5, 6, 7 /, ICOL / 1, 2, 3, 4, 5, 6 /
      DATA X / 0D0, 25D-2, 1D0, 25D-2, 2D0, 25D-2 /, NONE / 0 /
      DATA WIDE / 0D0, 0D0, 7D0, 1D0, 0D0, 7D0, 2D0, 0D0, 7D0 /
      DATA IDOF / 1, 2, 99, 3, 4, 99, 5, 6, 99 /
      DATA LINES / 1, 2, 2, 3 /, LOWER / 2, 1, 3, 2 /
      DATA F / 0D0, -4D0, 0D0, -7D0, 0D0, -4D0 /, OFFSET / 3 * 0D0 /
      DATA GROUND / 0D0, -9D0, 0D0, 1D0 /, ONE / 5D-1 /
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL OK(IERR, 'FTNEW')
      DO 10 K = 1, 2
        CALL FTBADD(IP, 6, IB, IERR)
        CALL OK(IERR, 'FTBADD')
        CALL FTBSTF(IP, IB, 6, IPTR, ICOL, A, FTLOWR, IERR)
        CALL OK(IERR, 'FTBSTF')
   10 CONTINUE
      CALL FTBLOD(IP, 2, 6, F, IERR)
      CALL OK(IERR, 'FTBLOD')
C     The slave, the master by numbers of all bodies, a plane, a tool.
      CALL FTSADD(IP, 2, 2, 3, X, 2, ICOL, 2, IS(1), IERR)
      CALL OK(IERR, 'FTSADD')
      CALL FTSFAC(IP, IS(1), FTLIN2, 2, LINES, IERR)
      CALL OK(IERR, 'FTSFAC')
      CALL FTSADD(IP, FTALL, 2, 3, WIDE, 3, IDOF, 3, IS(2), IERR)
      CALL OK(IERR, 'FTSADD')
      CALL FTSFAC(IP, IS(2), FTLIN2, 2, LOWER, IERR)
      CALL OK(IERR, 'FTSFAC')
      CALL FTSRIG(IP, 2, FTPLAN, GROUND, IS(3), IERR)
      CALL OK(IERR, 'FTSRIG')
      CALL FTSADD(IP, FTALL, 2, 3, X, 2, NONE, 0, IS(4), IERR)
      CALL OK(IERR, 'FTSADD of a tool')
      DO 20 K = 1, 4
   20 CALL HOLDS(IS(K) .EQ. K, 'surfaces count from 1')
      CALL FTSCNT(IP, IS(1), IDIM, N, NF, ND, IERR)
      CALL OK(IERR, 'FTSCNT')
      CALL HOLDS(IDIM .EQ. 2 .AND. N .EQ. 3 .AND. NF .EQ. 2 .AND.
     &  ND .EQ. 0, 'FTSCNT')
C     What is refused counts its arguments, and names the face.
      LINES(4) = 4
      CALL FTSFAC(IP, IS(4), FTLIN2, 2, LINES, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 5, 'a node that is not there')
      CALL FTEDET(FTNIDT, IDET, FTNRDT, RDET, NAME, IERR)
      CALL OK(IERR, 'FTEDET')
      CALL HOLDS(IDET(FTDFAC) .EQ. 2 .AND. IDET(FTDPAI) .EQ. 0,
     &  'FTDFAC')
      CALL FTSADD(IP, 2, 2, 3, X, 2, ICOL, 2, IS(4), IERR)
      CALL OK(IERR, 'FTSADD')
      CALL FTSADD(IP, 2, 2, 3, X, 2, ICOL, 1, I, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 8, 'columns of one unknown')
      CALL FTPADD(IP, 1, 1, FTNTOF, 1D0, IPAIR, IFIRST, IERR)
      CALL HOLDS(IERR .EQ. FTEUNS, 'a surface that meets itself')
      CALL FTPADD(IP, 0, 2, FTNTOF, 1D0, IPAIR, IFIRST, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 2, 'surface 0')
C     The pressures are 3.
      CALL FTPADD(IP, 1, 2, FTNTOF, 5D-1, IPAIR, IFIRST, IERR)
      CALL OK(IERR, 'FTPADD')
      CALL HOLDS(IPAIR .EQ. 1 .AND. IFIRST .EQ. 1, 'FTPADD')
      CALL FTPADD(IP, 1, 3, FTNTOF, 5D-1, IPAIR, IFIRST, IERR)
      CALL OK(IERR, 'FTPADD')
      CALL HOLDS(IPAIR .EQ. 2 .AND. IFIRST .EQ. 4, 'FTPADD')
      CALL FTPVAL(IP, 1, 'offset', 3, OFFSET, IERR)
      CALL OK(IERR, 'FTPVAL')
      CALL FTPVAL(IP, 1, 'offset', 2, OFFSET, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 4, 'two offsets of three nodes')
      CALL FTPFND(IP, IERR)
      CALL OK(IERR, 'FTPFND')
      CALL FTSOLV(IP, 0, INFO, 0, RINFO, IERR)
      CALL OK(IERR, 'FTSOLV')
      CALL FTPFLD(IP, 1, FTVPRE, 3, P, IERR)
      CALL OK(IERR, 'FTPFLD')
      DO 30 K = 1, 3
   30 CALL SAME(P(K), 3D0, 'a pressure')
      CALL FTPFLD(IP, 1, FTVNOR, 6, V, IERR)
      CALL OK(IERR, 'FTPFLD')
      CALL SAME(V(4), -1D0, 'the normal')
      CALL FTPFLD(IP, 1, FTVNOR, 3, V, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 4, 'three numbers of vectors')
      CALL FTPINF(IP, 1, FTNIPF, IPFACT, FTNRPF, RPFACT, IERR)
      CALL OK(IERR, 'FTPINF')
      CALL HOLDS(IPFACT(FTQROW) .EQ. 3 .AND. IPFACT(FTQWOP) .EQ. 0
     &  .AND. IPFACT(FTQCLO) .EQ. 3 .AND. IPFACT(FTQSTK) .EQ. 0 .AND.
     &  IPFACT(FTQPND) .GE. 1 .AND. IPFACT(FTQDND) .EQ. 0, 'FTPINF')
      CALL SAME(RPFACT(FTQFOR + 1), 6D0, 'the force on the slave')
      CALL SAME(RPFACT(FTQMOM + 2), 6D0, 'its moment')
      CALL SAME(RPFACT(FTQARE), 2D0, 'the closed area')
      CALL SAME(RPFACT(FTQPRE), 3D0, 'the largest pressure')
      CALL FTPINF(IP, 2, FTNIPF, IPFACT, 0, RPFACT, IERR)
      CALL OK(IERR, 'FTPINF')
      CALL HOLDS(IPFACT(FTQWOP) .EQ. 3, 'no node meets the plane')
C     Node 3 pulls with 1, in equilibrium: pair and node are named.
      CALL FTDISP(IP, FTALL, 12, U, IERR)
      CALL OK(IERR, 'FTDISP')
      CALL FTMULT(IP, FTKINE, 6, RLAM, IERR)
      CALL OK(IERR, 'FTMULT')
      RLAM(3) = -1D0
      U(6) = 25D-2
      U(12) = -125D-2
      CALL FTCHK(IP, 12, U, 6, RLAM, 0, RLT, FTNIVE, ICERT, FTNRVE,
     &  RCERT, IERR)
      CALL OK(IERR, 'FTCHK')
      CALL HOLDS(ICERT(FTVPAI) .EQ. 1 .AND. ICERT(FTVPND) .EQ. 3,
     &  'the worst pair')
      CALL FTDIAG(IP, FTNIDG, IDIAG, FTNRDG, RDIAG, IERR)
      CALL OK(IERR, 'FTDIAG')
      CALL HOLDS(IDIAG(FTGPAI) .EQ. 0 .AND. IDIAG(FTGPND) .EQ. 0,
     &  'a pair of the diagnosis')
C     The slave comes down to the master.
      CALL FTPCMT(IP, IERR)
      CALL OK(IERR, 'FTPCMT')
      DO 40 K = 2, 6, 2
   40 X(K) = 0D0
      CALL FTPVAL(IP, 1, 'friction', 1, ONE, IERR)
      CALL OK(IERR, 'FTPVAL')
      CALL FTSMOV(IP, 1, X, 2, IERR)
      CALL OK(IERR, 'FTSMOV')
      CALL FTPFND(IP, IERR)
      CALL OK(IERR, 'FTPFND')
      CALL FTSOLV(IP, 0, INFO, 0, RINFO, IERR)
      CALL OK(IERR, 'FTSOLV')
      CALL FTPFLD(IP, 1, FTVFOR, 3, P, IERR)
      CALL OK(IERR, 'FTPFLD')
      CALL SAME(P(2), 35D-1, 'the force without a gap')
      CALL FTPINF(IP, 1, FTNIPF, IPFACT, 0, RPFACT, IERR)
      CALL OK(IERR, 'FTPINF')
      CALL HOLDS(IPFACT(FTQSTK) .EQ. 3, 'nodes that stick')
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      END
