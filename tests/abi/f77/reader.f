C     What the FORTRAN 77 drivers share: readers of the files of a case
C     folder, and an end with a text where a claim does not hold.
C
C     Sparse MatrixMarket file, the entries in any order: row I has the
C     entries IPTR(I) to IPTR(I+1)-1 of ICOL and VAL, room for LROW rows
C     and LNZ entries.
      SUBROUTINE RDROWS(FILE, LROW, LNZ, NROW, NCOL, IPTR, ICOL, VAL)
      CHARACTER*(*) FILE
      INTEGER LROW, LNZ, NROW, NCOL, IPTR(LROW + 1), ICOL(LNZ)
      INTEGER I, J, K, NNZ
      DOUBLE PRECISION VAL(LNZ), A
      CALL RDOPEN(FILE)
      READ (11, *) NROW, NCOL, NNZ
      CALL HOLDS(NROW .LE. LROW .AND. NNZ .LE. LNZ, 'room for '//FILE)
      DO 10 I = 1, NROW + 1
   10 IPTR(I) = 0
      DO 20 K = 1, NNZ
      READ (11, *) I
   20 IF (I .LT. NROW) IPTR(I + 2) = IPTR(I + 2) + 1
      CLOSE (11)
      IPTR(1) = 1
      IPTR(2) = 1
      DO 30 I = 3, NROW + 1
   30 IPTR(I) = IPTR(I) + IPTR(I - 1)
C     IPTR(I+1) is where the next entry of row I goes.
      CALL RDOPEN(FILE)
      READ (11, *) I
      DO 40 K = 1, NNZ
      READ (11, *) I, J, A
      ICOL(IPTR(I + 1)) = J
      VAL(IPTR(I + 1)) = A
   40 IPTR(I + 1) = IPTR(I + 1) + 1
      CLOSE (11)
      END

C     MatrixMarket array file, column by column: X(N,NR), room for LX
C     numbers.
      SUBROUTINE RDCOLS(FILE, LX, N, NR, X)
      CHARACTER*(*) FILE
      INTEGER LX, N, NR, I
      DOUBLE PRECISION X(LX)
      CALL RDOPEN(FILE)
      READ (11, *) N, NR
      CALL HOLDS(N * NR .LE. LX, 'room for '//FILE)
      READ (11, *) (X(I), I = 1, N * NR)
      CLOSE (11)
      END

C     One number a line: X(N), room for LX numbers.
      SUBROUTINE RDVEC(FILE, LX, N, X)
      CHARACTER*(*) FILE
      INTEGER LX, N
      DOUBLE PRECISION X(LX)
      CALL RDOPEN(FILE)
      DO 10 N = 1, LX
   10 READ (11, *, END = 20) X(N)
   20 N = N - 1
      CLOSE (11)
      END

C     Opens a file on unit 11, behind the lines that start with a %.
      SUBROUTINE RDOPEN(FILE)
      CHARACTER*(*) FILE
      CHARACTER*1 FIRST
      LOGICAL FOUND
      INQUIRE (FILE = FILE, EXIST = FOUND)
      CALL HOLDS(FOUND, FILE//' not found')
      OPEN (11, FILE = FILE, STATUS = 'OLD')
   10 READ (11, '(A)') FIRST
      IF (FIRST .EQ. '%') GO TO 10
      BACKSPACE 11
      END

C     First command argument: the folder of the cases, with a slash.
      SUBROUTINE FOLDER(DIR, L)
      CHARACTER*(*) DIR
      INTEGER L
      CALL GET_COMMAND_ARGUMENT(1, DIR)
      L = INDEX(DIR, ' ')
      DIR(L:L) = '/'
      END

C     Ends with exit code 1 and a text where a claim does not hold.
      SUBROUTINE HOLDS(CLAIM, TEXT)
      LOGICAL CLAIM
      CHARACTER*(*) TEXT
      IF (CLAIM) RETURN
      WRITE (*, '(1X, A)') TEXT
      STOP 1
      END
