C     07 A host with its own factorisation: banded Cholesky, in a code
C     of the 1970s. FORTRAN 77, fixed form, data in COMMON.
C
C     A block of 12 mm x 4 mm is clamped to the ground (body 1), another
C     one lies on it and floats (body 2): plane strain, E = 1D4 N/mm**2
C     and nu = .3, 1 mm thick, squares of 1 mm. The bottom of the upper
C     block is slightly convex; 10 N press on each of the five nodes at
C     the left of its top, so that the contact opens on the right.
C
C     The host numbers the unknowns column by column and stores each K
C     as a band in LAPACK's format. Instead of a matrix it passes the
C     diagonal and one function for
C
C         Y = K X      the product with the band
C         Y = K+ X     solve with the banded factor
C
C     The clamped block has K+ = K**-1. K of the floating block is
C     singular: three of its unknowns are held, by rows and columns of
C     the identity in the factor and zeros in X and Y; they lie at the
C     lower corners, far apart.
C
C     The example solves twice: with this function, and with the
C     matrices themselves. The answers are equal, and the function lets
C     the library factorise nothing. Units: N and mm.
C
C     AK(1+i-j, j, IB) is K(i, j), AL likewise the factor; N(IB) is the
C     number of unknowns, JLOW(IB) the first line of nodes that has
C     unknowns, NHELD(IB) unknowns are held: IHELD(1..NHELD, IB).
      PROGRAM OWNFAC
      INCLUDE 'feti_contact_f77.inc'
      INTEGER NX, NY, MOST, KD
      PARAMETER (NX = 12, NY = 4)
      PARAMETER (MOST = 2 * (NX + 1) * (NY + 1), KD = 2 * (NY + 2) + 1)
      INTEGER N(2), JLOW(2), NHELD(2), IHELD(3, 2)
      DOUBLE PRECISION AK(KD+1, MOST, 2), AL(KD+1, MOST, 2)
      COMMON /BLOCKI/ N, JLOW, NHELD, IHELD
      COMMON /BLOCKS/ AK, AL
      INTEGER I, INFO(FTNINF), INFOM(FTNINF), KNOWN, NCLOSD
      LOGICAL OK
      DOUBLE PRECISION RINFO(FTNRIN), RINFOM(FTNRIN)
      DOUBLE PRECISION RLAM(NX+1), RLAMM(NX+1), U(MOST), UM(MOST)
      DOUBLE PRECISION SUM, ERR, ERROR

      CALL ASSEMB(1, 1)
      CALL ASSEMB(2, 0)
      NHELD(2) = 3
      IHELD(1, 2) = KNOWN(2, 0, 0)
      IHELD(2, 2) = KNOWN(2, 0, 0) + 1
      IHELD(3, 2) = KNOWN(2, NX, 0) + 1
      CALL FACTOR(1)
      CALL FACTOR(2)
      CALL CONTCT(.TRUE., INFO, RINFO, RLAM, U)
      CALL CONTCT(.FALSE., INFOM, RINFOM, RLAMM, UM)

      SUM = 0D0
      NCLOSD = 0
      DO 10 I = 1, NX + 1
        SUM = SUM + RLAM(I)
        IF (RLAM(I) .GT. 1D-6) NCLOSD = NCLOSD + 1
   10 CONTINUE
      CALL SHOW('contact force', SUM, 'N')
      CALL SHOW('nodes in contact', DBLE(NCLOSD), '-')
      CALL SHOW('top, left corner', 1D3 * U(KNOWN(2, 0, NY) + 1), 'um')
      CALL SHOW('top, right corner', 1D3 * U(KNOWN(2, NX, NY) + 1),
     &          'um')
      CALL SHOW('factorisations by the library', DBLE(INFO(FTIFAC)),
     &          '-')
      CALL SHOW('factorisations with matrices', DBLE(INFOM(FTIFAC)),
     &          '-')
      ERR = MAX(ERROR(NX + 1, RLAM, RLAMM), ERROR(N(2), U, UM))
      OK = INFO(FTIFAC) .EQ. 0 .AND. INFOM(FTISTA) .EQ. FTOK
      CALL DEMO(INFO, RINFO, ERR, OK .AND. ABS(SUM - 5D1) .LT. 1D-6)
      END

C     First unknown of node (i, j) of a block, 0 where it is clamped.
      INTEGER FUNCTION KNOWN(IB, I, J)
      INTEGER NY, IB, I, J
      PARAMETER (NY = 4)
      INTEGER N(2), JLOW(2), NHELD(2), IHELD(3, 2)
      COMMON /BLOCKI/ N, JLOW, NHELD, IHELD
      KNOWN = 0
      IF (J .GE. JLOW(IB))
     &  KNOWN = 2 * (I * (NY + 1 - JLOW(IB)) + J - JLOW(IB)) + 1
      END

C     Integral of dN(a)/dx(d) dN(c)/dx(e) over a square, N(a) the
C     bilinear function of corner a.
      DOUBLE PRECISION FUNCTION GRADS(IA, IC, ID, IE)
      INTEGER IA, IC, ID, IE
      DOUBLE PRECISION CORNER(2, 4)
      DATA CORNER / -1D0, -1D0, 1D0, -1D0, -1D0, 1D0, 1D0, 1D0 /
      GRADS = CORNER(ID, IA) * CORNER(IE, IC) / 4D0
      IF (ID .EQ. IE) GRADS = GRADS
     &  * (1D0 + CORNER(3 - ID, IA) * CORNER(3 - ID, IC) / 3D0)
      END

C     Entry of an element: lambda div v div u + 2 mu e(v):e(u).
      DOUBLE PRECISION FUNCTION ELEM(IA, ID, IC, IE)
      INTEGER IA, ID, IC, IE
      DOUBLE PRECISION E, XNU, XMU, XLAM, GRADS
      PARAMETER (E = 1D4, XNU = 0.3D0)
      PARAMETER (XMU = E / (2D0 * (1D0 + XNU)))
      PARAMETER (XLAM = 2D0 * XMU * XNU / (1D0 - 2D0 * XNU))
      ELEM = XLAM * GRADS(IA, IC, ID, IE) + XMU * GRADS(IA, IC, IE, ID)
      IF (ID .EQ. IE) ELEM = ELEM
     &  + XMU * (GRADS(IA, IC, 1, 1) + GRADS(IA, IC, 2, 2))
      END

C     K of a block whose unknowns begin on line JFIRST of its nodes.
      SUBROUTINE ASSEMB(IB, JFIRST)
      INTEGER NX, NY, MOST, KD, IB, JFIRST
      PARAMETER (NX = 12, NY = 4)
      PARAMETER (MOST = 2 * (NX + 1) * (NY + 1), KD = 2 * (NY + 2) + 1)
      INTEGER N(2), JLOW(2), NHELD(2), IHELD(3, 2)
      DOUBLE PRECISION AK(KD+1, MOST, 2), AL(KD+1, MOST, 2)
      COMMON /BLOCKI/ N, JLOW, NHELD, IHELD
      COMMON /BLOCKS/ AK, AL
      INTEGER I, J, IP, IQ, IROW, ICOL, KNOWN
      DOUBLE PRECISION ELEM
      JLOW(IB) = JFIRST
      N(IB) = 2 * (NX + 1) * (NY + 1 - JFIRST)
      NHELD(IB) = 0
      DO 20 J = 1, MOST
        DO 10 I = 1, KD + 1
          AK(I, J, IB) = 0D0
   10   CONTINUE
   20 CONTINUE
      DO 60 I = 0, NX - 1
        DO 50 J = 0, NY - 1
          DO 40 IP = 0, 7
            DO 30 IQ = 0, 7
              IROW = KNOWN(IB, I + MOD(IP / 2, 2), J + IP / 4)
              ICOL = KNOWN(IB, I + MOD(IQ / 2, 2), J + IQ / 4)
              IF (IROW .EQ. 0 .OR. ICOL .EQ. 0) GO TO 30
              IROW = IROW + MOD(IP, 2)
              ICOL = ICOL + MOD(IQ, 2)
              IF (IROW .LT. ICOL) GO TO 30
              AK(1 + IROW - ICOL, ICOL, IB) =
     &          AK(1 + IROW - ICOL, ICOL, IB) + ELEM(IP / 2 + 1,
     &          MOD(IP, 2) + 1, IQ / 2 + 1, MOD(IQ, 2) + 1)
   30       CONTINUE
   40     CONTINUE
   50   CONTINUE
   60 CONTINUE
      END

C     The factor of K with the held unknowns struck out.
      SUBROUTINE FACTOR(IB)
      INTEGER NX, NY, MOST, KD, IB
      PARAMETER (NX = 12, NY = 4)
      PARAMETER (MOST = 2 * (NX + 1) * (NY + 1), KD = 2 * (NY + 2) + 1)
      INTEGER N(2), JLOW(2), NHELD(2), IHELD(3, 2)
      DOUBLE PRECISION AK(KD+1, MOST, 2), AL(KD+1, MOST, 2)
      COMMON /BLOCKI/ N, JLOW, NHELD, IHELD
      COMMON /BLOCKS/ AK, AL
      INTEGER I, J, IH
      DO 20 J = 1, MOST
        DO 10 I = 1, KD + 1
          AL(I, J, IB) = AK(I, J, IB)
   10   CONTINUE
   20 CONTINUE
      DO 40 IH = 1, NHELD(IB)
        J = IHELD(IH, IB)
        DO 30 I = 1, KD
          AL(1 + I, J, IB) = 0D0
          IF (J - I .GE. 1) AL(1 + I, J - I, IB) = 0D0
   30   CONTINUE
        AL(1, J, IB) = 1D0
   40 CONTINUE
      CALL BNDFAC(N(IB), KD, AL(1, 1, IB), KD + 1)
      END

C     A = L L' in the band, A positive definite.
      SUBROUTINE BNDFAC(N, KD, A, LDA)
      INTEGER N, KD, LDA, I, J, K, M
      DOUBLE PRECISION A(LDA, N)
      DO 40 J = 1, N
        M = MIN(KD, N - J)
        A(1, J) = SQRT(A(1, J))
        DO 10 I = 1, M
          A(1 + I, J) = A(1 + I, J) / A(1, J)
   10   CONTINUE
        DO 30 K = 1, M
          DO 20 I = K, M
            A(1 + I - K, J + K) = A(1 + I - K, J + K)
     &                          - A(1 + I, J) * A(1 + K, J)
   20     CONTINUE
   30   CONTINUE
   40 CONTINUE
      END

C     x := (L L')**-1 x
      SUBROUTINE BNDSOL(N, KD, A, LDA, X)
      INTEGER N, KD, LDA, I, J
      DOUBLE PRECISION A(LDA, N), X(N)
      DO 20 J = 1, N
        X(J) = X(J) / A(1, J)
        DO 10 I = 1, MIN(KD, N - J)
          X(J + I) = X(J + I) - A(1 + I, J) * X(J)
   10   CONTINUE
   20 CONTINUE
      DO 40 J = N, 1, -1
        DO 30 I = 1, MIN(KD, N - J)
          X(J) = X(J) - A(1 + I, J) * X(J + I)
   30   CONTINUE
        X(J) = X(J) / A(1, J)
   40 CONTINUE
      END

C     y := y + K x
      SUBROUTINE BNDMUL(N, KD, A, LDA, X, Y)
      INTEGER N, KD, LDA, I, J
      DOUBLE PRECISION A(LDA, N), X(N), Y(N)
      DO 20 J = 1, N
        Y(J) = Y(J) + A(1, J) * X(J)
        DO 10 I = 1, MIN(KD, N - J)
          Y(J + I) = Y(J + I) + A(1 + I, J) * X(J)
          Y(J) = Y(J) + A(1 + I, J) * X(J + I)
   10   CONTINUE
   20 CONTINUE
      END

C     Y = K+ X or Y = K X of block IB: called by the library with 1 to
C     32 columns, Y full of zeros. 0: done.
      INTEGER FUNCTION BANDED(IWHAT, IB, NU, NRHS, X, LDX, Y, LDY)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IWHAT, IB, NU, NRHS, LDX, LDY
      DOUBLE PRECISION X(LDX, NRHS), Y(LDY, NRHS)
      INTEGER NX, NY, MOST, KD
      PARAMETER (NX = 12, NY = 4)
      PARAMETER (MOST = 2 * (NX + 1) * (NY + 1), KD = 2 * (NY + 2) + 1)
      INTEGER N(2), JLOW(2), NHELD(2), IHELD(3, 2)
      DOUBLE PRECISION AK(KD+1, MOST, 2), AL(KD+1, MOST, 2)
      COMMON /BLOCKI/ N, JLOW, NHELD, IHELD
      COMMON /BLOCKS/ AK, AL
      INTEGER I, J
      BANDED = 1
      IF (NU .NE. N(IB)) RETURN
      DO 30 J = 1, NRHS
        IF (IWHAT .EQ. FTKPLS) THEN
          DO 10 I = 1, NU
            Y(I, J) = X(I, J)
   10     CONTINUE
          DO 20 I = 1, NHELD(IB)
            Y(IHELD(I, IB), J) = 0D0
   20     CONTINUE
          CALL BNDSOL(NU, KD, AL(1, 1, IB), KD + 1, Y(1, J))
        ELSE
          CALL BNDMUL(NU, KD, AK(1, 1, IB), KD + 1, X(1, J), Y(1, J))
        END IF
   30 CONTINUE
      BANDED = 0
      END

C     Solves with the function of the host (OWN) or with its matrices:
C     forces of the rows, displacements of the upper block.
      SUBROUTINE CONTCT(OWN, INFO, RINFO, RLAM, U)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER NX, NY, MOST
      PARAMETER (NX = 12, NY = 4)
      PARAMETER (MOST = 2 * (NX + 1) * (NY + 1))
      INTEGER N(2), JLOW(2), NHELD(2), IHELD(3, 2)
      COMMON /BLOCKI/ N, JLOW, NHELD, IHELD
      LOGICAL OWN
      INTEGER INFO(FTNINF), IWORD(2), IP, IB, IERR, I, KNOWN
      DOUBLE PRECISION RINFO(FTNRIN), RLAM(NX+1), U(MOST)
      DOUBLE PRECISION DWORD(2), F(MOST)
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /

      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL SURE(IERR)
      CALL FTSETD(IP, 'tolerance', 1D-10, IERR)
      CALL SURE(IERR)
      CALL FTBADD(IP, N(1), IB, IERR)
      CALL SURE(IERR)
      CALL GIVE(IP, IB, OWN)
      CALL FTBADD(IP, N(2), IB, IERR)
      CALL SURE(IERR)
      CALL GIVE(IP, IB, OWN)
      DO 10 I = 1, MOST
        F(I) = 0D0
   10 CONTINUE
      DO 20 I = 0, 4
        F(KNOWN(2, I, NY) + 1) = -1D1
   20 CONTINUE
      CALL FTBLOD(IP, 2, N(2), F, IERR)
      CALL SURE(IERR)
      CALL ROWS(IP)
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL SURE(IERR)
      CALL FTMULT(IP, FTKINE, NX + 1, RLAM, IERR)
      CALL SURE(IERR)
      CALL FTDISP(IP, 2, N(2), U, IERR)
      CALL SURE(IERR)
      CALL FTFREE(IP, IERR)
      CALL SURE(IERR)
      END

C     Stiffness of a block, by its function or as a matrix: the lower
C     triangle by columns is the upper triangle by rows. Null space: two
C     translations and a rotation about the lower left corner; the
C     clamped block has none.
      SUBROUTINE GIVE(IP, IB, OWN)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER NX, NY, MOST, KD
      PARAMETER (NX = 12, NY = 4)
      PARAMETER (MOST = 2 * (NX + 1) * (NY + 1), KD = 2 * (NY + 2) + 1)
      INTEGER N(2), JLOW(2), NHELD(2), IHELD(3, 2)
      DOUBLE PRECISION AK(KD+1, MOST, 2), AL(KD+1, MOST, 2)
      COMMON /BLOCKI/ N, JLOW, NHELD, IHELD
      COMMON /BLOCKS/ AK, AL
      LOGICAL OWN
      INTEGER IP, IB, IERR, I, J, IX, NENT, KNOWN, BANDED
      INTEGER IPTR(MOST+1), ICOL((KD+1)*MOST)
      DOUBLE PRECISION DIAG(MOST), VAL((KD+1)*MOST), R(MOST, 3)
      EXTERNAL BANDED
      NENT = 0
      DO 20 J = 1, N(IB)
        DIAG(J) = AK(1, J, IB)
        IPTR(J) = NENT + 1
        DO 10 I = J, MIN(N(IB), J + KD)
          NENT = NENT + 1
          ICOL(NENT) = I
          VAL(NENT) = AK(1 + I - J, J, IB)
   10   CONTINUE
   20 CONTINUE
      IPTR(N(IB) + 1) = NENT + 1
      IF (OWN) THEN
        CALL FTBOPR(IP, IB, N(IB), DIAG, BANDED, 0, IERR)
      ELSE
        CALL FTBSTF(IP, IB, N(IB), IPTR, ICOL, VAL, FTUPPR, IERR)
      END IF
      CALL SURE(IERR)
      DO 40 I = 0, NX
        DO 30 J = JLOW(IB), NY
          IX = KNOWN(IB, I, J)
          R(IX, 1) = 1D0
          R(IX + 1, 1) = 0D0
          R(IX, 2) = 0D0
          R(IX + 1, 2) = 1D0
          R(IX, 3) = -DBLE(J)
          R(IX + 1, 3) = DBLE(I)
   30   CONTINUE
   40 CONTINUE
      CALL FTBNUL(IP, IB, NHELD(IB), N(IB), R, MOST, FTEXCT, IERR)
      CALL SURE(IERR)
      END

C     u(y) of the lower block - u(y) of the upper one <= gap along the
C     line of contact; the middle of the upper block keeps its place
C     along x: nothing else keeps it from sliding.
      SUBROUTINE ROWS(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER NX, NY
      PARAMETER (NX = 12, NY = 4)
      INTEGER IP, I, J, IERR, KNOWN
      INTEGER IPTR(NX+2), IBODY(2*NX+2), IDOF(2*NX+2)
      DOUBLE PRECISION VAL(2*NX+2), GAP(NX+1), X, CROWN, ZERO(1)
      PARAMETER (CROWN = 1D-3)
      DATA ZERO / 0D0 /
      DO 10 I = 0, NX
        X = (I - NX / 2) / (NX / 2D0)
        IPTR(I + 1) = 2 * I + 1
        IBODY(2 * I + 1) = 1
        IDOF(2 * I + 1) = KNOWN(1, I, NY) + 1
        VAL(2 * I + 1) = 1D0
        IBODY(2 * I + 2) = 2
        IDOF(2 * I + 2) = KNOWN(2, I, 0) + 1
        VAL(2 * I + 2) = -1D0
        GAP(I + 1) = CROWN * X * X
   10 CONTINUE
      IPTR(NX + 2) = 2 * NX + 3
      CALL FTROWS(IP, FTKINE, NX + 1, IPTR, IBODY, IDOF, VAL, GAP, J,
     &            IERR)
      CALL SURE(IERR)
      IBODY(1) = 2
      IDOF(1) = KNOWN(2, NX / 2, 0)
      IPTR(2) = 2
      CALL FTROWS(IP, FTKEQU, 1, IPTR, IBODY, IDOF, VAL, ZERO, J, IERR)
      CALL SURE(IERR)
      END

C     Ends the program with the words of the library when a call fails.
      SUBROUTINE SURE(IERR)
      INTEGER IERR
      CHARACTER*300 TEXT
      IF (IERR .EQ. 0) RETURN
      CALL FTERR(IERR, TEXT)
      WRITE (*, *) TEXT
      STOP 1
      END

C     max |x - ref| / max |ref|
      DOUBLE PRECISION FUNCTION ERROR(N, X, REF)
      INTEGER N, I
      DOUBLE PRECISION X(N), REF(N), SIZE
      ERROR = 0D0
      SIZE = 0D0
      DO 10 I = 1, N
        ERROR = MAX(ERROR, ABS(X(I) - REF(I)))
        SIZE = MAX(SIZE, ABS(REF(I)))
   10 CONTINUE
      IF (SIZE .GT. 0D0) ERROR = ERROR / SIZE
      END

C     One result: name, value, unit. The C twin prints the same lines.
      SUBROUTINE SHOW(NAME, VALUE, UNIT)
      CHARACTER*(*) NAME, UNIT
      CHARACTER*32 LABEL
      DOUBLE PRECISION VALUE
      LABEL = NAME
      WRITE (*, 10) LABEL, VALUE, UNIT
   10 FORMAT (A32, F16.6, 1X, A)
      END

C     The demo line, and code 1 where the library does not report FTOK,
C     its certificate fails, ERR > 1D-7 or the checks do not hold.
      SUBROUTINE DEMO(INFO, RINFO, ERR, CHECKS)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER INFO(FTNINF), I, L
      DOUBLE PRECISION RINFO(FTNRIN), ERR, CERT
      LOGICAL CHECKS, OK
      CHARACTER*5 WORD
      CERT = 0D0
      DO 10 I = FTREQM, FTRGAP
        CERT = MAX(CERT, RINFO(I))
   10 CONTINUE
      OK = CHECKS .AND. INFO(FTISTA) .EQ. FTOK
      OK = OK .AND. RINFO(FTRWOR) .LE. 1D0 .AND. ERR .LE. 1D-7
      WORD = 'short'
      L = 5
      IF (OK) THEN
        WORD = 'ok'
        L = 2
      END IF
      WRITE (*, 20) INFO(FTIDOF), INFO(FTIROW), INFO(FTIACT), CERT, ERR,
     &              RINFO(FTRSUP) + RINFO(FTRSOL), WORD(1:L)
   20 FORMAT ('demo 07_own_factorisation fortran unknowns', I4, ' rows',
     &        I3, ' active', I3, ' certificate', 1PE8.1, ' error', E8.1,
     &        ' seconds', 0PF6.3, 1X, A)
      IF (.NOT. OK) STOP 1
      END
