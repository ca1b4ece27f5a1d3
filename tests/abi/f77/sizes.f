C     A host whose INTEGER or DOUBLE PRECISION has not the size of that
C     of the face is told so, with its text, and nothing beside IERR is
C     written. First argument of the program: the status that is due.
      PROGRAM SIZES
      INTEGER IWORD(2), IDUE, IA, IP, IB, IERR, IC
      DOUBLE PRECISION DWORD(2)
      CHARACTER ARG*20, TEXT*200
      COMMON /GUARD/ IA, IP, IB, IERR, IC
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /
      CALL GET_COMMAND_ARGUMENT(1, ARG)
      READ (ARG, *) IDUE
      IA = 71
      IP = 72
      IB = 73
      IERR = 74
      IC = 75
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL FTERR(IERR, TEXT)
      CALL HOLDS(IERR .EQ. IDUE, 'status: '//TEXT)
      CALL HOLDS(IA .EQ. 71 .AND. IP .EQ. 72 .AND. IB .EQ. 73 .AND. IC
     &  .EQ. 75, 'something beside IERR was written')
      CALL HOLDS(INDEX(TEXT, 'INTEGER') .GT. 0 .AND. IDUE .EQ. -1001
     &  .OR. INDEX(TEXT, 'DOUBLE') .GT. 0 .AND. IDUE .EQ. -1002, TEXT)
C     Words that were never set, or in the wrong order, are refused too.
      IWORD(1) = 2
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL HOLDS(IERR .NE. 0 .AND. IP .EQ. 72, 'wrong words')
      END
