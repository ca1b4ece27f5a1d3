C     Functions of the host that hear of a solve, cancel it, fail; they
C     share their data with the program by COMMON.
      PROGRAM WATCH
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, INFO(FTNINF), N
      INTEGER NCALL, NSTEP, MODE, IPR, IBUSY
      DOUBLE PRECISION RINFO(FTNRIN), F(2), FRAC
      COMMON /DIARY/ FRAC, NCALL, NSTEP, MODE, IPR, IBUSY
      INTEGER HEAR
      EXTERNAL HEAR
      DATA F / 0D0, -2D1 /
      CALL SMALL(IP)
      IPR = IP
      NCALL = 0
      NSTEP = 0
      MODE = 0
      FRAC = 0D0
      CALL FTONPR(IP, HEAR, IERR)
      CALL OK(IERR, 'FTONPR')
      CALL SOLVES(IP, 10D0, -0.3D0, 'a solve that is heard')
      CALL HOLDS(NCALL .GT. 0 .AND. NSTEP .GT. 0, 'nothing was heard')
      CALL HOLDS(FRAC .GT. 0D0 .AND. FRAC .LE. 1D0, 'part of the setup')
C     From inside the problem is busy, but for FTCANC and FTPERR.
      MODE = 1
      CALL FTBLOD(IP, 2, 2, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL HOLDS(IERR .EQ. FTWCAN, 'FTCANC from inside')
      CALL HOLDS(IBUSY .EQ. FTEBSY, 'a call from inside')
C     A number > 0 cancels, a number < 0 is a failure of the host.
      MODE = 2
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL HOLDS(IERR .EQ. FTWCAN .AND. INFO(FTISTA) .EQ. FTWCAN,
     &  'a result > 0')
      MODE = 3
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL HOLDS(IERR .EQ. FTECBK, 'a result < 0')
C     Nothing is heard any more; cancelling nothing is no error.
      N = NCALL
      CALL FTOFPR(IP, IERR)
      CALL OK(IERR, 'FTOFPR')
      CALL FTCANC(IP, IERR)
      CALL OK(IERR, 'FTCANC')
      CALL SOLVES(IP, 20D0, -0.5D0, 'a solve after all')
      CALL HOLDS(NCALL .EQ. N, 'it is heard after FTOFPR')
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      END

      INTEGER FUNCTION HEAR(NOW, RNOW)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER NOW(5), NCALL, NSTEP, MODE, IPR, IBUSY, IERR, L
      DOUBLE PRECISION RNOW(6), FRAC
      CHARACTER*40 TEXT
      COMMON /DIARY/ FRAC, NCALL, NSTEP, MODE, IPR, IBUSY
      HEAR = 0
      NCALL = NCALL + 1
      IF (NOW(FTNPHA) .EQ. FTPSET) FRAC = RNOW(FTNFRA)
      IF (NOW(FTNPHA) .EQ. FTPSOL) NSTEP = NOW(FTNSTP)
      IF (MODE .EQ. 1) THEN
        CALL FTSTUP(IPR, IBUSY)
        CALL FTPERR(IPR, TEXT, L, IERR)
        CALL OK(IERR, 'FTPERR')
        CALL FTCANC(IPR, IERR)
        CALL OK(IERR, 'FTCANC')
      END IF
      IF (MODE .EQ. 2) HEAR = 5
      IF (MODE .EQ. 3) HEAR = -5
      END
