C     A chain of two springs on the ground, a bar before it, given by
C     their elements and cut in two, against the answer by hand: the
C     chain has k = 100, the bar k = 50 twice, it is pushed by 10 across
C     a gap of .1. Then the chain twice as stiff, and refused calls.
      SUBROUTINE ELEMS
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, IB, I, J, NE, IWORD(2), INFO(FTNINF), IF(FTNIBD)
      INTEGER IPTR(3), IDOF1(4), IDOF2(4), IDOFH(4), IPTRB(2), IBODB(2)
      INTEGER IDOFB(2), NODE(3), IDIR(3), IPC(3), ID(FTNIDT), NANA
      DOUBLE PRECISION DWORD(2), A(4), TWO(6), X(3), F(3), B(2), C(1)
      DOUBLE PRECISION RF(FTNRBD), RINFO(FTNRIN), R(2), U(3), RD(FTNRDT)
      DOUBLE PRECISION BAD(4)
      CHARACTER NAME*40
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /
      DATA IPTR / 1, 3, 5 /, IDOF1 / 0, 1, 1, 2 /, IDOF2 / 1, 2, 2, 3 /
      DATA IDOFH / 0, 1, 1, 4 /
      DATA A / 1D2, -1D2, -1D2, 1D2 /, BAD / 1D2, -1D2, 0D0, 1D2 /
      DATA TWO / 5D1, -5D1, 5D1, 5D1, -5D1, 5D1 /
      DATA X / 1D0, 2D0, 3D0 /, NODE / 1, 2, 3 /, IDIR / 3 * 1 /
      DATA F / 0D0, 0D0, -1D1 /, B / 1D0, -1D0 /, C / 0.1D0 /
      DATA IPTRB / 1, 3 /, IBODB / 1, 2 /, IDOFB / 2, 1 /
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL OK(IERR, 'FTNEW')
      CALL FTSETI(IP, 'pieces', 2, IERR)
      CALL OK(IERR, 'FTSETI')
      DO 10 IB = 1, 2
        CALL FTBADD(IP, IB + 1, I, IERR)
        CALL OK(IERR, 'FTBADD')
        CALL FTBXYZ(IP, IB, 1, IB + 1, NODE, IDIR, X, 1, IERR)
   10   CALL OK(IERR, 'FTBXYZ')
      CALL FTBLOD(IP, 2, 3, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL FTROWS(IP, FTKINE, 1, IPTRB, IBODB, IDOFB, B, C, I, IERR)
      CALL OK(IERR, 'FTROWS')
C     Refused: before the connectivity, an unknown beyond the last one.
      CALL FTBELM(IP, 1, 1, 2, A, 2, IERR)
      CALL HOLDS(IERR .EQ. FTESTA, 'an element before FTBMSH')
      CALL FTBMSH(IP, 1, 2, IPTR, IDOFH, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 5, 'FTBMSH, unknown 4 of 2')
      CALL FTEDET(FTNIDT, ID, FTNRDT, RD, NAME, IERR)
      CALL OK(IERR, 'FTEDET')
      CALL HOLDS(ID(FTDELM) .EQ. 2 .AND. ID(FTDBOD) .EQ. 1, 'FTDELM')
      CALL FTBMSH(IP, 1, 0, IPTR, IDOF1, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 3, 'FTBMSH without elements')
      CALL FTBMSH(IP, 1, 2, IPTR, IDOF1, IERR)
      CALL OK(IERR, 'FTBMSH')
      CALL FTBELM(IP, 1, 2, 2, A, 2, IERR)
      CALL OK(IERR, 'FTBELM')
C     Twice, not there, of another size, not symmetric; one is missing.
      CALL FTBELM(IP, 1, 2, 2, A, 2, IERR)
      CALL HOLDS(IERR .EQ. FTESTA, 'an element twice')
      CALL FTBELM(IP, 1, 0, 2, A, 2, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 3, 'element 0')
      CALL FTBELM(IP, 1, 3, 2, A, 2, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 3, 'element 3 of 2')
      CALL FTBELM(IP, 1, 1, 1, A, 2, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 4, 'a matrix of one row')
      CALL FTBELM(IP, 1, 1, 2, BAD, 2, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 5, 'a matrix not symmetric')
      CALL FTBELM(IP, 1, 1, 2, A, 1, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 6, 'leading dimension 1')
      CALL FTBELS(IP, 1, 3, 1, TWO, FTLOWR, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 3, 'a block from element 3 of 2')
      CALL FTBELS(IP, 1, 1, 3, TWO, FTLOWR, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 4, 'a block of 3 of 2')
      CALL FTBELS(IP, 1, 1, 1, TWO, 7, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 6, 'storage 7')
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL HOLDS(IERR .EQ. FTESTA, 'an element is missing')
      CALL FTEDET(FTNIDT, ID, FTNRDT, RD, NAME, IERR)
      CALL OK(IERR, 'FTEDET')
      CALL HOLDS(ID(FTDELM) .EQ. 1, 'the element that is missing')
      CALL FTBELM(IP, 1, 1, 2, A, 2, IERR)
      CALL OK(IERR, 'FTBELM')
      CALL FTBMSH(IP, 2, 2, IPTR, IDOF2, IERR)
      CALL OK(IERR, 'FTBMSH')
      NE = 0
      CALL FTBESZ(IP, 2, 1, 2, FTLOWR, NE, IERR)
      CALL OK(IERR, 'FTBESZ')
      CALL HOLDS(NE .EQ. 6, 'FTBESZ')
      CALL FTBELS(IP, 2, 1, 2, TWO, FTLOWR, IERR)
      CALL OK(IERR, 'FTBELS')
      NANA = 0
      DO 30 J = 1, 2
        CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
        CALL OK(IERR, 'FTSOLV')
        IF (J .EQ. 1) NANA = INFO(FTIANA)
        CALL HOLDS(INFO(FTIANA) .EQ. NANA, 'a pass was analysed')
        CALL FTDISP(IP, 1, 2, U, IERR)
        CALL OK(IERR, 'FTDISP')
        CALL SAME(U(1), -0.1D0 / J, 'chain by elements')
        CALL SAME(U(2), -0.2D0 / J, 'chain by elements')
        CALL FTDISP(IP, 2, 3, U, IERR)
        CALL OK(IERR, 'FTDISP')
        CALL SAME(U(1), -0.2D0 / J - 0.1D0, 'bar by elements')
        CALL SAME(U(3), -0.2D0 / J - 0.5D0, 'bar by elements')
        CALL FTBHLD(IP, 1, 2, R, IERR)
        CALL OK(IERR, 'FTBHLD')
        CALL SAME(R(1), 10D0, 'force of the ground')
        CALL SAME(R(2), 0D0, 'a held unknown of no element')
        IF (J .EQ. 2) GOTO 40
C       The chain twice as stiff: a second pass on its old pattern.
        DO 20 I = 1, 4
   20   A(I) = 2 * A(I)
        CALL FTBELM(IP, 1, 1, 2, A, 2, IERR)
        CALL OK(IERR, 'FTBELM')
        CALL FTBELM(IP, 1, 2, 2, A, 2, IERR)
   30   CALL OK(IERR, 'FTBELM')
   40 CALL FTBINF(IP, 2, FTNIBD, IF, FTNRBD, RF, IERR)
      CALL OK(IERR, 'FTBINF')
      CALL HOLDS(IF(FTBPCE) .EQ. 2 .AND. IF(FTBUNK) .EQ. 3, 'FTBPCE')
      CALL FTBPCS(IP, 2, 3, IPC, IERR)
      CALL OK(IERR, 'FTBPCS')
      CALL HOLDS(MIN(IPC(1), IPC(3)) .EQ. 1 .AND. MAX(IPC(1), IPC(3))
     &  .EQ. 2 .AND. IPC(2) .EQ. 1, 'FTBPCS')
      CALL FTBKPL(IP, 2, 3, 1, F, 3, U, 3, IERR)
      CALL HOLDS(IERR .EQ. FTESTA, 'K+ of a body that is cut')
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      END
