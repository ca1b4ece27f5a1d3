C     A problem written, read back and solved; options by one text; what
C     a function of the host is told in words.
      PROGRAM SAVED
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IQ, IERR, IWORD(2), NLINE, LAST, IFAIL, NB, N, M, ME
      INTEGER INFO(1)
      DOUBLE PRECISION DWORD(2), D, RINFO(1)
      CHARACTER PATH*200
      COMMON /LINES/ NLINE, LAST, IFAIL
      INTEGER LISTEN
      EXTERNAL LISTEN
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /
      CALL GET_COMMAND_ARGUMENT(1, PATH)
      CALL SMALL(IP)
      CALL FTSETT(IP, 'tolerance=1e-11 threads=1', IERR)
      CALL OK(IERR, 'FTSETT')
      CALL FTGETD(IP, 'tolerance', D, IERR)
      CALL OK(IERR, 'FTGETD')
      CALL SAME(D * 1D11, 1D0, 'tolerance')
      CALL FTSETT(IP, 'tolerance=1e-12 thread=1', IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 2, 'an option that there is not')
      CALL FTWRIT(IP, PATH, IERR)
      CALL OK(IERR, 'FTWRIT')
      CALL FTNEW(IWORD, DWORD, IQ, IERR)
      CALL OK(IERR, 'FTNEW')
      CALL FTREAD(IQ, PATH(1:20), IERR)
      CALL HOLDS(IERR .EQ. FTEIO, 'a file that there is not')
      CALL FTREAD(IQ, PATH, IERR)
      CALL OK(IERR, 'FTREAD')
      CALL FTCNTS(IQ, NB, N, M, ME, IERR)
      CALL OK(IERR, 'FTCNTS')
      CALL HOLDS(NB .EQ. 3 .AND. N .EQ. 5 .AND. M .EQ. 2 .AND. ME .EQ.
     &  1, 'what was read')
      NLINE = 0
      LAST = 0
      IFAIL = 0
      CALL FTONLG(IQ, LISTEN, 4, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 3, 'level 4')
      CALL FTONLG(IQ, LISTEN, FTLPHA, IERR)
      CALL OK(IERR, 'FTONLG')
      CALL SOLVES(IQ, 10D0, -0.3D0, 'what was read')
      CALL HOLDS(NLINE .GT. 1, 'no line was told')
      IFAIL = 3
      CALL FTSOLV(IQ, 0, INFO, 0, RINFO, IERR)
      CALL HOLDS(IERR .EQ. FTECBK, 'a failure of the function')
      CALL FTOFLG(IQ, IERR)
      CALL OK(IERR, 'FTOFLG')
      N = NLINE
      CALL SOLVES(IQ, 10D0, -0.3D0, 'a silent solve')
      CALL HOLDS(NLINE .EQ. N, 'a line after FTOFLG')
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      CALL FTFREE(IQ, IERR)
      CALL OK(IERR, 'FTFREE')
      END

      INTEGER FUNCTION LISTEN(LEVEL, TEXT)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER LEVEL, NLINE, LAST, IFAIL
      CHARACTER*(*) TEXT
      COMMON /LINES/ NLINE, LAST, IFAIL
      LISTEN = IFAIL
      IF (TEXT .EQ. ' ' .OR. LEVEL .GT. FTLPHA) LISTEN = 99
      NLINE = NLINE + 1
      LAST = LEN(TEXT)
      END
