C     INTEGER of 8 bytes: a number that would be valid with its upper
C     half cut off is refused.
      PROGRAM WIDE
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, L, N, IPTR(3), ICOL(3), NODE(2), IDIR(2)
      DOUBLE PRECISION A(3), X(2), C(1)
      CHARACTER TEXT*200
      DATA IPTR / 1, 2, 4 /, ICOL / 1, 1, 2 /, A / 5D1, -5D1, 5D1 /
      DATA NODE / 1, 2 /, IDIR / 1, 1 /, X / 0D0, 1D0 /, C / 0D0 /
      L = 65536
      L = L * L
      CALL HOLDS(L .GT. 0, 'INTEGER has not 8 bytes')
      CALL SMALL(IP)
      CALL FTBSTF(IP, 2, 2, IPTR, ICOL, A, L + FTLOWR, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 7, 'storage is cut')
      CALL FTBNUL(IP, 2, 1, 2, X, 2, L + FTCAND, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 7, 'flag is cut')
      CALL FTRRHS(IP, L + FTKINE, 1, 1, C, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 2, 'kind is cut')
      CALL FTRRHS(IP, FTKINE, L + 1, 1, C, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 3, 'row is cut')
      CALL FTBXYZ(IP, 2, L + 1, 2, NODE, IDIR, X, 1, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 3, 'dimension is cut')
      IDIR(1) = L + 1
      CALL FTBXYZ(IP, 2, 1, 2, NODE, IDIR, X, 1, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 6, 'direction is cut')
      IDIR(1) = 1
      NODE(1) = L + 1
      CALL FTBXYZ(IP, 2, 1, 2, NODE, IDIR, X, 1, IERR)
      CALL HOLDS(IERR .EQ. FTEFIT, 'label of a node is cut')
      CALL FTERR(IERR, TEXT)
      CALL HOLDS(INDEX(TEXT, 'does not fit') .GT. 0, TEXT)
      ICOL(2) = L + 1
      CALL FTBSTF(IP, 2, 2, IPTR, ICOL, A, FTLOWR, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 5, 'column is cut')
C     The text is that of the call, not one of an earlier call.
      N = L * 65536 * 4096
      CALL FTBCMP(IP, 2, N, ICOL, IERR)
      CALL FTERR(IERR, TEXT)
      CALL HOLDS(IERR .EQ. FTEMEM .AND. INDEX(TEXT, 'emory') .GT. 0,
     &  TEXT)
      N = L + IP
      CALL FTSTUP(N, IERR)
      CALL HOLDS(IERR .EQ. FTEHDL, 'handle is cut')
      CALL SOLVES(IP, 10D0, -0.3D0, 'a problem after refused calls')
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      END
