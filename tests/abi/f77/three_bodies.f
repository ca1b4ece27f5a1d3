C     Three stacked blocks in space, from CalculiX: matrices, motions,
C     supports (H u = 0), contact rows (B u <= 0) of meshes that do not
C     match; 100 MPa press on a part of the top. Prints the forces.
      PROGRAM THREE
      INCLUDE 'feti_contact_f77.inc'
      INTEGER LN, LNZ, LM
      PARAMETER (LN = 7101, LNZ = 150000, LM = 400)
      INTEGER IWORD(2), IP, IERR, IB, N, NR, NU, M, ME, I, J, K, L, N1
      INTEGER IPTR(LN + 1), ICOL(LNZ), INFO(FTNINF)
      DOUBLE PRECISION DWORD(2), VAL(LNZ), R(6 * LN), F(LN), C(LM)
      DOUBLE PRECISION RLAM(LM), REF(LM), RINFO(FTNRIN), S(2), E
      CHARACTER DIR*200, P*200, DIGIT(3)*1
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /, DIGIT / '1', '2', '3' /
      CALL FOLDER(DIR, L)
      P = DIR(1:L)//'three_bodies/'
      L = INDEX(P, ' ') - 1
      CALL FTNEW(IWORD, DWORD, IP, IERR)
      CALL STOPS(IERR)
      CALL RDVEC(P(1:L)//'f.txt', LN, NU, F)
      K = 1
      DO 10 J = 1, 3
        CALL RDROWS(P(1:L)//'K'//DIGIT(J)//'.mtx', LN, LNZ, N, I, IPTR,
     &    ICOL, VAL)
        CALL FTBADD(IP, N, IB, IERR)
        CALL STOPS(IERR)
        CALL FTBSTF(IP, IB, N, IPTR, ICOL, VAL, FTLOWR, IERR)
        CALL STOPS(IERR)
        CALL RDCOLS(P(1:L)//'R'//DIGIT(J)//'.mtx', 6 * LN, N, NR, R)
        CALL FTBNUL(IP, IB, NR, N, R, N, FTEXCT, IERR)
        CALL STOPS(IERR)
        CALL FTBLOD(IP, IB, N, F(K), IERR)
        CALL STOPS(IERR)
        IF (J .EQ. 1) N1 = N
   10   K = K + N
      CALL RDROWS(P(1:L)//'H.mtx', LN, LNZ, ME, NU, IPTR, ICOL, VAL)
      CALL RDVEC(P(1:L)//'h.txt', LM, ME, C)
      CALL FTROWC(IP, FTKEQU, ME, IPTR, ICOL, VAL, C, I, IERR)
      CALL STOPS(IERR)
      CALL RDROWS(P(1:L)//'B.mtx', LN, LNZ, M, NU, IPTR, ICOL, VAL)
      CALL RDVEC(P(1:L)//'c.txt', LM, M, C)
      CALL FTROWC(IP, FTKINE, M, IPTR, ICOL, VAL, C, I, IERR)
      CALL STOPS(IERR)
      CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO, IERR)
      CALL STOPS(IERR)
      CALL FTMULT(IP, FTKINE, M, RLAM, IERR)
      CALL STOPS(IERR)
      CALL FTFREE(IP, IERR)
      CALL STOPS(IERR)
C     A row that touches the base (body 1) belongs to base and middle.
      CALL RDVEC(P(1:L)//'lambda_ref.txt', LM, M, REF)
      E = 0D0
      S(1) = 0D0
      S(2) = 0D0
      DO 30 I = 1, M
        K = 2
        DO 20 J = IPTR(I), IPTR(I + 1) - 1
   20     IF (ICOL(J) .LE. N1) K = 1
        S(K) = S(K) + RLAM(I)
   30   E = MAX(E, ABS(RLAM(I) - REF(I)))
      WRITE (*, '(A, F12.6)') 'force base on middle [N]', S(1),
     &  'force middle on top [N]', S(2)
      CALL HOLDS(RINFO(FTRWOR) .LE. 1D0, 'the certificate fails')
      CALL HOLDS(E .LE. 1D-7 * S(2), 'a force is not the known one')
      END

C     Ends with the library's text where a call did not succeed.
      SUBROUTINE STOPS(IERR)
      INTEGER IERR
      CHARACTER*300 TEXT
      CALL FTERR(IERR, TEXT)
      CALL HOLDS(IERR .EQ. 0, TEXT)
      END
